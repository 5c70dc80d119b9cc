#!/usr/bin/env python3
"""reliability_table.py on made-up results, and tests/faults/faults.json: whatever it names is there."""
import fnmatch
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))
REPOSITORY = SCRIPT.resolve().parent.parent
FAULTS = REPOSITORY / "tests/faults/faults.json"
CASE = '<testcase name="faults.{}" time="{}" status="{}"><system-out>{}</system-out></testcase>'


def fault(name, tests, missing=""):
    return {"name": name, "promise": f"promise of {name}", "tests": tests, "missing": missing}


class ReliabilityTableTest(unittest.TestCase):
    def page(self, faults, cases):
        with tempfile.TemporaryDirectory() as folder:
            table, results = Path(folder) / "faults.json", Path(folder) / "results.xml"
            table.write_text(json.dumps(faults))
            results.write_text("<testsuite>" + "".join(CASE.format(*case) for case in cases) + "</testsuite>")
            return subprocess.run([sys.executable, "-B", SCRIPT, table, results, "abc1234"], capture_output=True, text=True)

    def test_states_follow_from_results_and_from_what_is_missing(self):
        tests = {"good": "a_test --gtest_filter=A.*", "bad": "tests/b_test.py Case", "away": "c_test"}
        faults = [fault("F1", ["good"]), fault("F2", ["good"], "half of it."), fault("F3", ["good", "bad"]),
                  fault("F4", []), fault("F5", ["away"]), {**fault("F6", ["good"], "more."), "holds": False}]
        cases = [("good", 2.04, "run", "line\n[x] figure: 12 ms\nfigure: 3 MB\n"), ("bad", 1, "fail", ""),
                 ("away", 0, "notrun", "")]
        result = self.page({"tests": tests, "faults": faults, "found": [fault("1", ["good"])]}, cases)
        self.assertEqual(result.returncode, 0, result.stderr)
        for row in ("| F1 | promise of F1 | holds | `good` |  |", "| F2 | promise of F2 | in part | `good` | half of it. |",
                    "| F3 | promise of F3 | FAILS | `good`, `bad` |  |", "| F4 | promise of F4 | no test yet |  |  |",
                    "| F5 | promise of F5 | in part | `away` | Skipped here: `away`. |",
                    "| F6 | promise of F6 | does not hold | `good` | more. |", "| 1 | promise of 1 | holds | `good` |  |",
                    "| `good` | `build/release/bin/a_test --gtest_filter=A.*` | passed | 2.0 | 12 ms; 3 MB |",
                    "| `bad` | `build/release/bin/lapis_in_private_domain tests/b_test.py Case` | FAILED | 1.0 |  |"):
            self.assertIn(row, result.stdout)
        self.assertIn("Last run: commit abc1234, ", result.stdout)
        self.assertIn("holds 1, in part 2, does not hold 1, FAILS 1, no test yet 1.", result.stdout)

    def test_results_that_are_absent_are_named(self):
        result = self.page({"tests": {"gone": "a_test"}, "faults": [], "found": []}, [])
        self.assertEqual(result.returncode, 1)
        self.assertIn("no results of gone", result.stderr)


class FaultsTest(unittest.TestCase):
    def setUp(self):
        self.table = json.loads(FAULTS.read_text())
        sources = "\n".join(file.read_text() for file in (REPOSITORY / "tests").rglob("*_test.cpp"))
        self.cases = {".".join(found) for found in re.findall(r"\bTEST(?:_F|_P)?\((\w+), (\w+)\)", sources)}

    def test_all_faults_are_listed_and_all_tests_used(self):
        self.assertEqual([fault["name"] for fault in self.table["faults"]], [f"F{i}" for i in range(1, 24)])
        self.assertEqual([fault["name"] for fault in self.table["found"]], [str(i) for i in range(1, 14)])
        used = {test for fault in self.table["faults"] + self.table["found"] for test in fault["tests"]}
        self.assertEqual(used, set(self.table["tests"]))

    def test_each_part_of_a_filter_fits_a_test(self):
        filters = [part for command in self.table["tests"].values() if "--gtest_filter=" in command
                   for part in command.partition("--gtest_filter=")[2].split(":")]
        self.assertGreater(len(filters), 30)
        unknown = [part for part in filters if not fnmatch.filter(self.cases, part.partition("/")[0])]  # without parameters
        self.assertEqual(unknown, [])

    def test_scripts_and_their_cases_are_there(self):
        for command in self.table["tests"].values():
            script, *words = command.split()
            if not script.endswith(".py"):
                continue
            text = (REPOSITORY / script).read_text()
            for word in words:
                for part in word.split(".") if not word.startswith("--") else [word]:
                    self.assertIn(part, text, command)


if __name__ == "__main__":
    unittest.main(verbosity=2)
