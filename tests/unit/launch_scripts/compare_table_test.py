#!/usr/bin/env python3
"""compare_table.py on made-up runs: pairs are found by what the runs are of, and a failed one is reported."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))


class CompareTableTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.runs = []

    def add_run(self, variant, name, seed, error_m, has_succeeded=True):
        folder = self.folder / variant / name
        folder.mkdir(parents=True)
        self.runs.append(f"{variant}={folder}")
        run = {"scene": "/scenes/flat.yaml", "method": "tour", "seed": seed}
        (folder / "metrics.json").write_text(json.dumps({
            "run": run, "exit_reason": "completed", "planner_state": None, "map_error_mean_m": error_m,
            "tier_vision_share": 1 - error_m, "lost_share": error_m}))
        if has_succeeded:
            (folder / "identity").write_text("0\n")

    def compare(self):
        return subprocess.run([sys.executable, "-B", SCRIPT, *self.runs], capture_output=True, text=True)

    def test_pairs_are_found_by_scene_and_seed_whatever_their_folders_are_called(self):
        for seed, error_m in ((1, 0.01), (2, 0.03)):
            self.add_run("fine", f"x{seed}", seed, error_m)
            self.add_run("coarse", f"y{seed}", seed, error_m + 0.02)
        result = self.compare()
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [line.split(" | ")[:2] for line in result.stdout.splitlines() if line.startswith("| flat_")]
        self.assertEqual(rows, [["| flat_1", "fine"], ["| flat_1", "coarse"], ["| flat_2", "fine"], ["| flat_2", "coarse"]])
        self.assertIn(" | vision % | surfaces % | odometry % | lost % |", result.stdout)
        self.assertIn("| flat_2 | coarse | - | - | - | 95.0 | - | - | 5.0 |", result.stdout)
        self.assertIn("| map error cm | coarse | 2 | +2.0000 | +2.0000 to +2.0000 |", result.stdout)

    def test_a_run_that_failed_is_named_and_in_no_difference(self):
        self.add_run("fine", "a", 1, 0.01)
        self.add_run("coarse", "b", 1, 0.5, has_succeeded=False)
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"failed: {self.folder}/coarse/b", result.stderr)
        self.assertIn("| flat_1 | coarse | - |", result.stdout)
        self.assertNotIn("| map error cm | coarse |", result.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
