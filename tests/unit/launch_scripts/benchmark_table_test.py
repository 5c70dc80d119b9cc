#!/usr/bin/env python3
"""benchmark_table.py on made-up runs: outcomes, medians, and tables that are put together from earlier ones."""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))
METRICS = {"exit_reason": "completed", "planner_state": "DONE", "explored_share": 0.9, "time_to_80_s": 50.0,
           "explored_share_with_margin": 0.925, "stalled_share": 0.04, "failures": 3, "time_to_90_s": None,
           "path_length_m": 40.0, "collisions": 0, "keyframe_ate_se3_rmse_m": 0.0125,
           "tier_vision_share": 0.75, "tier_surfaces_share": 0.125, "tier_odometry_share": 0.1, "lost_share": 0.025}


class BenchmarkTableTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_folder(self, name, has_succeeded=True, **changes):
        """Its name in the file system says nothing of the run."""
        scene, method, seed = name.split("/")
        run = {"system": "explore", "scene": f"/scenes/{scene}.yaml", "method": method,
               "seed": int(seed.removeprefix("seed_")), "commit": "abc123"}
        folder = self.folder / f"folder_{len(list(self.folder.iterdir()))}"
        folder.mkdir()
        (folder / "metrics.json").write_text(json.dumps(METRICS | {"run": run} | changes))
        (folder / "simulation.yaml").write_text("hardest_push_m_s: 0.25  # speed towards what was touched\n")
        if has_succeeded:
            (folder / "identity").write_text("0\n")
        return folder

    def table(self, target, *sources):
        """Exit status, and the cells of each line of the table."""
        result = subprocess.run([sys.executable, "-B", SCRIPT, self.folder / target, *sources], capture_output=True,
                                text=True)
        self.assertEqual(result.stderr, "")
        lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in result.stdout.splitlines()]
        return result.returncode, [dict(zip(lines[0], line)) for line in lines[2:]]

    def test_runs_and_their_median(self):
        status, rows = self.table("runs.csv", self.run_folder("flat/lapis/seed_1"),
                                  self.run_folder("flat/lapis/seed_2", explored_share=0.7, time_to_80_s=None),
                                  self.run_folder("flat/lapis/seed_3", explored_share=0.95, planner_state="EXPLORING"))
        self.assertEqual(status, 0)
        self.assertEqual([row["outcome"] for row in rows], ["done", "done", "time up", "2 done, 1 time up"])
        self.assertEqual([row["explored %"] for row in rows], ["90.0", "70.0", "95.0", "90.0"])
        self.assertEqual([row["80 % s"] for row in rows], ["50", "-", "50", "50"])
        shown = [rows[0][name] for name in ("explored with margin %", "no progress %", "failures")]
        self.assertEqual(shown, ["92.5", "4.0", "3"])
        shown = [rows[0][name] for name in ("key-frame ATE SE3 cm", "vision %", "surfaces %", "odometry %", "lost %")]
        self.assertEqual(shown, ["1.2", "75.0", "12.5", "10.0", "2.5"])
        self.assertEqual([row["90 % s"] for row in rows], ["-"] * 4)
        self.assertEqual([row["hardest push m/s"] for row in rows], ["0.25"] * 4)
        self.assertEqual([row["commit"] for row in rows], ["abc123"] * 3 + ["-"])

    def test_what_consolidates_at_the_end_is_done_or_has_given_up(self):
        reasons = ("revisits an old place; nothing is left that can be reached",
                   "revisits an old place; what is left was tried in vain; frontiers left: 2.0 m: left alone for now")
        _, rows = self.table("runs.csv", *(self.run_folder(f"flat/lapis/seed_{seed}", planner_state="CONSOLIDATING",
                                                           planner_reason=reason)
                                           for seed, reason in enumerate(reasons, start=1)))
        self.assertEqual([row["outcome"] for row in rows[:2]], ["done", "gave up"])

    def test_a_run_that_failed_is_reported_and_is_in_no_median(self):
        status, rows = self.table("runs.csv", self.run_folder("flat/tare/seed_1"),
                                  self.run_folder("flat/tare/seed_2", has_succeeded=False, explored_share=0.1))
        self.assertEqual(status, 1)
        self.assertEqual([row["outcome"] for row in rows], ["done", "FAILED", "1 done, 1 FAILED"])
        self.assertEqual(rows[-1]["explored %"], "90.0")

    def test_buildings_of_a_kind_have_a_median(self):
        _, rows = self.table("runs.csv", *(self.run_folder(f"clinic_{i}/tour/seed_1", lost_share=i / 100) for i in (1, 2, 6)),
                             self.run_folder("clinic_1/nearest/seed_1"), self.run_folder("flat_1/tour/seed_1"))
        self.assertEqual([(row["scene"], row["seed"], row["lost %"]) for row in rows],
                         [("clinic_1", "1", "1.0"), ("clinic_2", "1", "2.0"), ("clinic_6", "1", "6.0"),
                          ("clinic_1", "1", "2.5"), ("flat_1", "1", "2.5"), ("clinic_*", "median of 3", "2.0")])

    def test_a_run_without_metrics_is_reported_by_its_manifest(self):
        folder = self.folder / "somewhere"
        folder.mkdir()
        (folder / "manifest.yaml").write_text('version: "lapis 0.1.0"\nrun:\n  commit: "abc123"\n  method: "tare"\n'
                                              '  scene: "flat"\n  seed: 4\nexit_status:\n  slam: null\n')
        status, rows = self.table("runs.csv", folder)
        self.assertEqual(status, 1)
        self.assertEqual([rows[0][name] for name in ("scene", "method", "seed", "outcome", "commit")],
                         ["flat", "tare", "4", "FAILED", "abc123"])

    def test_tables_can_be_put_together(self):
        runs = [self.run_folder("flat/lapis/seed_1"), self.run_folder("flat/lapis/seed_2", time_to_80_s=None),
                self.run_folder("hall/lapis/seed_1", explored_share=0.5)]
        whole = self.table("whole.csv", *runs)
        self.table("first.csv", runs[0])
        self.assertEqual(self.table("joined.csv", self.folder / "first.csv", *runs[1:]), whole)
        self.assertEqual(self.table("again.csv", self.folder / "joined.csv"), whole)
        self.assertEqual((self.folder / "again.csv").read_text(), (self.folder / "whole.csv").read_text())

    def test_a_table_from_before_a_column_was_there_can_be_read(self):
        _, rows = self.table("whole.csv", self.run_folder("flat/lapis/seed_1"))
        with (self.folder / "whole.csv").open(newline="") as stream:
            table = csv.DictReader(stream)
            older = [{name: value for name, value in row.items() if name != "hardest push m/s"} for row in table]
        with (self.folder / "older.csv").open("w", newline="") as stream:
            writer = csv.DictWriter(stream, older[0])
            writer.writeheader()
            writer.writerows(older)
        status, joined = self.table("joined.csv", self.folder / "older.csv")
        self.assertEqual(status, 0)
        self.assertEqual(joined, [row | {"hardest push m/s": "-"} for row in rows])

    def test_rows_of_a_file_that_is_not_there(self):
        missing = self.folder / "none.csv"
        result = subprocess.run([sys.executable, "-B", SCRIPT, "--rows", missing], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (1, f"{missing}: no such file\n"))

    def test_what_is_no_table_is_refused(self):
        other = self.folder / "other.csv"
        other.write_text("scene,method\n1,2\n")
        log = self.folder / "seed_1.log"
        log.write_text("of a run")
        for source, complaint in ((self.folder / "none.csv", "no such file"), (other, "no table of benchmark.sh"),
                                  (log, "neither a run folder nor a CSV file")):
            result = subprocess.run([sys.executable, "-B", SCRIPT, self.folder / "runs.csv", source],
                                    capture_output=True, text=True)
            self.assertEqual(result.returncode, 1)
            self.assertIn(f"{source}: {complaint}", result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
