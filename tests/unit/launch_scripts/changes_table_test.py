#!/usr/bin/env python3
"""changes_table.py on made-up decisions: what it counts, and what it refuses."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))
HEADER = "decision,candidate,is_chosen,is_chosen_with_prior_0.05,is_chosen_with_prior_0.5,rejection\n"
# The first decision is another with 0.5, the second with both, the third with none; the fourth has nothing to choose.
ROWS = ("1,0,1,1,0,\n1,1,0,0,1,\n"
        "2,0,0,0,1,\n2,1,1,0,0,\n2,2,0,1,0,\n"
        "3,0,1,1,1,\n"
        "4,0,0,0,0,\"cannot be reached, alas\"\n")


class ChangesTableTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_folder(self, name, text):
        folder = self.folder / name
        folder.mkdir()
        (folder / "decisions.csv").write_text(text)
        return folder

    def table(self, *folders):
        return subprocess.run([sys.executable, "-B", SCRIPT, *folders], capture_output=True, text=True)

    def test_shares_of_a_run_and_of_all(self):
        first = self.run_folder("first", HEADER + ROWS)
        second = self.run_folder("second", HEADER + "1,0,1,1,0,\n1,1,0,0,1,\n")
        self.assertEqual(self.table(first, second).stdout.splitlines(),
                         ["| run | decisions | changed by prior 0.05 % | changed by prior 0.5 % |",
                          "| --- | --- | --- | --- |",
                          f"| {first} | 3 | 33.3 | 66.7 |",
                          f"| {second} | 1 | 0.0 | 100.0 |",
                          "| all | 4 | 25.0 | 75.0 |"])

    def test_methods_are_compared_likewise(self):
        folder = self.run_folder("methods", (HEADER + ROWS).replace("with_prior_0.05", "by_mi_only"))
        self.assertEqual(self.table(folder).stdout.splitlines()[0::2],
                         ["| run | decisions | changed by mi_only % | changed by prior 0.5 % |",
                          f"| {folder} | 3 | 33.3 | 66.7 |"])

    def test_a_run_without_decisions_has_no_share(self):
        folder = self.run_folder("idle", HEADER)
        self.assertEqual(self.table(folder).stdout.splitlines()[-1], f"| {folder} | 0 | - | - |")

    def test_a_run_that_compares_nothing_is_refused(self):
        result = self.table(self.run_folder("plain", "decision,is_chosen\n1,1\n"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("planner.compared_methods", result.stderr)

    def test_runs_of_other_priors_are_refused(self):
        first = self.run_folder("first", HEADER)
        second = self.run_folder("second", HEADER.replace("0.05", "0.1"))
        third = self.run_folder("third", HEADER.replace("with_prior_0.05", "by_paper"))
        self.assertEqual(self.table(first, second).returncode, 1)
        self.assertEqual(self.table(first, third).returncode, 1)


if __name__ == "__main__":
    unittest.main()
