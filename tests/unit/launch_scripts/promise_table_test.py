"""promise_table.py: sums, fifths and correlation of made-up paths."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))
HEADER = "method,ended_kind,ended_cost_m,ended_promised_nats,ended_driven_nats,ended_gained_nats"


class PromiseTableTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, rows, name="paths.csv"):
        file = self.folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text("\n".join([HEADER, *rows]) + "\n")
        return file

    def table(self, *arguments):
        """Exit status, cells of the lines, and what went wrong."""
        result = subprocess.run([sys.executable, "-B", SCRIPT, *arguments], capture_output=True, text=True, check=False)
        self.assertNotIn("Traceback", result.stderr)
        return (result.returncode, [[cell.strip() for cell in line.split("|")[1:-1]] for line in
                                    result.stdout.splitlines()[2:]], result.stderr)

    def test_sums_fifths_and_correlation(self):
        file = self.write([f"nearest,frontier,2,{10 * (i + 1)},{10 * (i + 1)},{5 * (i + 1)}" for i in range(10)] + ["nearest,,,,,"])
        status, rows, _ = self.table(file)
        self.assertEqual((status, len(rows)), (0, 6))
        self.assertEqual(rows[0], ["nearest", "all", "10", "550", "275", "0.50", "1.00"])
        self.assertEqual(rows[1][:6], ["nearest", "10 to 20", "2", "30", "15", "0.50"])
        self.assertEqual(rows[5][1], "90 to 100")

    def test_a_path_that_was_left_is_in_the_fifth_of_its_whole_promise(self):
        file = self.write([f"nearest,frontier,2,{10 * (i + 1)},{10 * (i + 1)},10" for i in range(4)] +
                          ["nearest,frontier,9,99,1,20"])
        rows = self.table(file)[1]
        self.assertEqual(rows[1][:6], ["nearest", "10 to 10", "1", "10", "10", "1.00"])
        self.assertEqual(rows[5][:6], ["nearest", "99 to 99", "1", "1", "20", "20.00"])

    def test_a_gain_against_the_promise_correlates_negatively_and_equal_ranks_are_shared(self):
        file = self.write([f"joint,frontier,1,{p},{p},{g}" for p, g in ((1, 3), (2, 2), (3, 1))])
        self.assertEqual(self.table(file)[1][0][-1], "-1.00")
        file = self.write([f"joint,frontier,1,{p},{p},{g}" for p, g in ((1, 1), (2, 1), (3, 1))])
        self.assertEqual(self.table(file)[1][0][-1], "-")
        file = self.write([f"joint,frontier,1,{p},{p},{g}" for p, g in ((1, 1), (2, 1), (2, 4), (3, 4))])
        self.assertEqual(self.table(file)[1][0][-1], "0.71")

    def test_known_space_counts_apart(self):
        file = self.write(["nearest,frontier,2,10,10,10"] * 3 + ["nearest,known,10,6,6,1", "nearest,known,10,0,0,5",
                                                                   "nearest,driven,4,2,2,0"])
        rows = self.table(file)[1]
        self.assertEqual(rows[0][2:6], ["3", "30", "30", "1.00"])
        self.assertEqual(rows[-2], ["nearest", "known space, 20 m", "2", "6", "6", "1.00", "0.50 nats per m apart"])
        self.assertEqual(rows[-1], ["nearest", "driven before, 4 m", "1", "2", "0", "0.00", "0.50 nats per m apart"])

    def test_methods_apart_from_folders_and_files(self):
        self.write(["joint,gap,1,10,10,20"], "run/decisions.csv")
        file = self.write(["nearest,frontier,1,10,10,5"])
        rows = self.table(self.folder / "run", file)[1]
        of_all = [(row[0], row[5]) for row in rows if row[1] == "all"]
        self.assertEqual(of_all, [("joint", "2.00"), ("nearest", "0.50")])

    def test_says_what_is_wrong(self):
        for arguments, words in (([self.folder / "none"], "no such file"), ([], "usage"),
                                 ([self.write(["nearest,,,,,"])], "no path ended")):
            status, _, problem = self.table(*arguments)
            self.assertNotEqual(status, 0)
            self.assertIn(words, problem)
        (self.folder / "old.csv").write_text("decision,method\n1,joint\n")
        (self.folder / "empty.csv").write_text("")
        self.assertIn("is empty", self.table(self.folder / "empty.csv")[2])
        self.assertIn("the column ended_", self.table(self.folder / "old.csv")[2])


if __name__ == "__main__":
    unittest.main()
