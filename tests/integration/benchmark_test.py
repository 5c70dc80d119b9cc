#!/usr/bin/env python3
"""benchmark.sh: a row for each run, what is done is not done again, and a run that fails is a row, too."""
import csv
import os
import shutil

import chain

COMMIT = "6007e82"  # which looks like a number


def rows_of(file):
    """None when there is no such file."""
    if not file.exists():
        return None
    with open(file, newline="", encoding="utf-8") as table:
        return list(csv.DictReader(table))


class BenchmarkTest(chain.ChainTest):
    def setUp(self):
        super().setUp()
        git = self.folder / "programs/git"
        git.parent.mkdir()
        git.write_text(f"#!/bin/sh\necho {COMMIT}\n", encoding="utf-8")
        git.chmod(0o755)

    def benchmark(self, *options, status=0):
        scene = self.folder / "flat.yaml"
        scene.write_text(chain.FLAT)
        command = ["env", f"PATH={self.folder}/programs:{os.environ['PATH']}", chain.REPOSITORY / "launch_scripts/benchmark.sh", "--scenes", f"{scene}:10",
                   "--methods", "nearest", "--out", self.folder / "benchmark", *options]
        run = chain.Process(command, self.folder / "benchmark.log")
        self.addCleanup(run.kill)
        self.assertEqual(run.wait(150), status, run.output())
        return run.output(), rows_of(self.folder / "benchmark/runs.csv")

    def stamp_of(self, seed):
        return (self.folder / f"benchmark/flat/nearest/seed_{seed}/metrics.json").stat().st_mtime_ns

    def test_what_is_done_is_not_done_again(self):
        _, rows = self.benchmark("--runs", "1")
        self.assertEqual([(row["seed"], row["outcome"]) for row in rows], [("1", "time up")])
        self.assertEqual(rows[0]["commit"].removesuffix("-not-built"), COMMIT)
        done = self.stamp_of(1)
        metrics = chain.metrics_of(self.folder / "benchmark/flat/nearest/seed_1")
        output, rows = self.benchmark("--runs", "2")
        self.assertEqual([row["seed"] for row in rows], ["1", "2"], output)
        self.assertEqual(self.stamp_of(1), done, "played again")
        self.assertAlmostEqual(float(rows[0]["path m"]), metrics["path_length_m"], places=6)
        self.assertIn("| flat | nearest | median of 2 | 2 time up |", output)
        for name in ("boxes", "coverage"):
            self.assertGreater((self.folder / f"benchmark/figures/flat_{name}.png").stat().st_size, 1000)

    def test_a_table_has_all_figures_and_outlives_the_folder(self):
        table = self.folder / "poses.csv"
        output, _ = self.benchmark("--runs", "1", "--table", table)
        metrics = chain.metrics_of(self.folder / "benchmark/flat/nearest/seed_1")
        row, = rows_of(table)
        self.assertEqual((row["scene"], row["method"], row["seed"], row["outcome"]), ("flat", "nearest", "1", "time up"))
        for key, value in metrics.items():
            if isinstance(value, (int, float)):
                self.assertEqual(float(row[key]), value, key)
        self.assertEqual(float(row["cpu_ms_per_frame.slam"]), metrics["cpu_ms_per_frame"]["slam"])
        shares = [float(row[f"{name}_share"]) for name in ("tier_vision", "tier_surfaces", "tier_odometry", "lost")]
        self.assertAlmostEqual(sum(shares), 1.0, places=9)
        shutil.rmtree(self.folder / "benchmark")
        again, _ = self.benchmark("--runs", "1", "--table", table)
        self.assertFalse((self.folder / "benchmark/flat").exists(), "played again")
        self.assertEqual(*([line for line in text.splitlines() if line.startswith("|")] for text in (output, again)))

    def test_a_run_that_fails_is_a_row_and_is_tried_again(self):
        output, rows = self.benchmark("--runs", "1", "--set", "planner.method=no_such_method", status=1)
        self.assertEqual([row["outcome"] for row in rows], ["FAILED"], output)
        self.assertIn("planner.method", output)
        _, rows = self.benchmark("--runs", "1")
        self.assertEqual([row["outcome"] for row in rows], ["time up"])


if __name__ == "__main__":
    chain.main()
