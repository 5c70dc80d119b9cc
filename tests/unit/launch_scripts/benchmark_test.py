#!/usr/bin/env python3
"""benchmark.sh with programs that only pretend: which runs it plays, and what it keeps of them with --table.

usage: benchmark_test.py REPOSITORY
"""
import csv
import os
import shutil
import signal
import subprocess
import unittest

from pretended_programs import PretendedPrograms


class BenchmarkTest(PretendedPrograms):
    def setUp(self):
        super().setUp()
        self.table = self.folder / "results/poses.csv"

    def command(self, *options):
        return [self.folder / "launch_scripts/benchmark.sh", "--out", self.folder / "out", "--runs", "1", *options]

    def benchmark(self, *options, status=0):
        """What it prints, and what is played."""
        played = self.folder / "bin/played"
        played.unlink(missing_ok=True)
        result = subprocess.run(self.command(*options), env=self.environment(), capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        lines = played.read_text().splitlines() if played.exists() else []
        return result.stdout + result.stderr, [line.split()[0] for line in lines]

    def keep(self, *options, status=0):
        return self.benchmark("--table", self.table, *options, status=status)

    def rows(self):
        with self.table.open(newline="") as stream:
            return list(csv.DictReader(stream))

    def test_a_range_stands_for_generated_buildings(self):
        output, played = self.benchmark("--scenes", "clinic_[8-10]:20,flat_2", "--methods", "nearest")
        self.assertEqual(played, [f"{scene}/nearest/1" for scene in ("clinic_8", "clinic_9", "clinic_10", "flat_2")])
        self.assertIn("| clinic_* | nearest | median of 3 | 3 completed |", output)
        self.assertNotIn("flat_*", output)
        output, played = self.benchmark("--scenes", "clinic_[3-2]", status=2)
        self.assertIn("nothing is in this range", output)
        self.assertEqual(played, [])

    def test_each_run_is_a_row_with_all_figures(self):
        output, _ = self.keep("--scenes", "clinic_[1-2]", "--methods", "tour,nearest", "--set", "slam.x=1", "--set", "slam.y=2")
        rows = self.rows()
        self.assertEqual([(row["scene"], row["method"], row["seed"], row["outcome"]) for row in rows],
                         [(scene, method, "1", "completed") for scene in ("clinic_1", "clinic_2")
                          for method in ("tour", "nearest")])
        for row in rows:
            self.assertEqual((row["commit"].removesuffix("-not-built"), row["settings"], row["world"]),
                             ("6007e82", "slam.x=1 slam.y=2", ""))
            self.assertEqual((float(row["lost_share"]), float(row["cpu_ms_per_frame.slam"])), (0.25, 6.5))
            self.assertEqual((row["collisions"], row["cpu_ms_per_frame.planner"]), ("", ""))
            self.assertFalse({"run", "iou_by_class"} & set(row))
        self.assertEqual([row["key"] == rows[0]["key"] for row in rows], [True, False, True, False])
        self.assertIn("| clinic_2 | nearest | 1 | completed |", output)
        cells = dict(zip(*([cell.strip() for cell in line.split("|")] for line in output.splitlines()
                           if line.startswith(("| scene ", "| clinic_2 | nearest | 1 ")))))
        self.assertEqual((cells["lost %"], cells["vision %"]), ("25.0", "-"))
        self.assertFalse((self.folder / "out/runs.csv").exists())

    def test_what_has_a_row_is_not_played_again_even_when_its_folder_is_gone(self):
        scenes = ("--scenes", "clinic_1", "--methods", "nearest")
        first, _ = self.keep(*scenes)
        before = self.table.read_bytes()
        shutil.rmtree(self.folder / "out")
        again, played = self.keep(*scenes)
        self.assertEqual(played, [])
        self.assertEqual(self.table.read_bytes(), before)
        table = [line for line in first.splitlines() if line.startswith("|")]
        self.assertEqual([line for line in again.splitlines() if line.startswith("|")], table)
        self.assertEqual(self.keep("--scenes", "clinic_[1-2]", "--methods", "nearest", "--runs", "2")[1],
                         ["clinic_1/nearest/2", "clinic_2/nearest/1", "clinic_2/nearest/2"])
        self.assertTrue(self.table.read_bytes().startswith(before))

    def test_a_folder_that_has_the_run_is_enough_for_a_row(self):
        self.benchmark("--scenes", "clinic_1")
        self.assertEqual(self.keep("--scenes", "clinic_1")[1], [])
        self.assertEqual([row["scene"] for row in self.rows()], ["clinic_1"])

    def test_the_key_is_that_of_the_programs_that_take_part_and_of_settings_and_world(self):
        def keys_after(change):
            change()
            played = self.keep(*options)[1]
            return played, [row["key"] for row in self.rows()]

        world = self.folder / "w.yaml"
        world.write_text("noisy: 1\n")
        options = ["--scenes", "flat_1", "--methods", "tour,nearest", "--world", world]
        both, tour, nearest = ["flat_1/tour/1", "flat_1/nearest/1"], ["flat_1/tour/1"], ["flat_1/nearest/1"]
        changes = [
            (both, lambda: None),
            ([], lambda: None),
            ([], lambda: (self.folder / "launch_scripts/a_script.py").write_text("other")),
            ([], lambda: self.script("bin/lapis_sensor_replay", "other")),
            (nearest, lambda: self.script("bin/lapis_planner", "#!/bin/sh\n# another\n")),
            (both, lambda: self.script("bin/lapis_slam", "other")),
            (both, lambda: (self.folder / "config/robot.yaml").write_text("robot: {}\n")),
            (both, lambda: world.write_text("noisy: 2\n")),
            (both, lambda: options.extend(["--set", "slam.x=1"])),
            (nearest, lambda: options.extend(["--then", "none"])),
        ]
        seen, expected = set(), 0
        for index, (wanted, change) in enumerate(changes):
            with self.subTest(index):
                played, keys = keys_after(change)
                self.assertEqual(played, wanted)
                expected += len(wanted)
                self.assertEqual((len(keys), len(set(keys))), (expected, expected), "rows of other keys stay")
                self.assertLess(seen, {*keys, ""})
                seen = set(keys)
        moved = world.rename(self.folder / "elsewhere.yaml")
        options[options.index(world)] = moved
        self.assertEqual(self.keep(*options)[1], [], "where the world's file is does not matter")
        self.assertEqual({row["world"] for row in self.rows()}, {"w"})

    def test_a_run_that_fails_is_a_row_and_is_played_again(self):
        self.order(status={"clinic_2/tour/1": 1})
        output, _ = self.keep("--scenes", "clinic_[1-3]", status=1)
        self.assertEqual([(row["scene"], row["seed"], row["outcome"]) for row in self.rows()],
                         [("clinic_1", "1", "completed"), ("clinic_2", "1", "FAILED"), ("clinic_3", "1", "completed")])
        self.assertIn("| clinic_* | tour | median of 2 | 2 completed, 1 FAILED |", output)
        self.order()
        self.assertEqual(self.keep("--scenes", "clinic_[1-3]")[1], ["clinic_2/tour/1"])
        self.assertEqual([(row["scene"], row["outcome"]) for row in self.rows()],
                         [(f"clinic_{i}", "completed") for i in (1, 3, 2)])

    def test_an_interrupted_benchmark_goes_on_where_the_rows_end(self):
        self.order(status={"clinic_2/tour/1": 130})
        self.keep("--scenes", "clinic_[1-3]", status=130)
        self.assertEqual([row["scene"] for row in self.rows()], ["clinic_1"])
        self.order()
        self.assertEqual(self.keep("--scenes", "clinic_[1-3]")[1], ["clinic_2/tour/1", "clinic_3/tour/1"])

    def test_programs_that_change_during_a_run_make_no_row(self):
        self.order(rebuild=["clinic_2/tour/1"])
        output, _ = self.keep("--scenes", "clinic_[1-3]", status=2)
        self.assertIn("clinic_2, tour, seed 1: programs or configuration have changed", output)
        self.assertEqual([row["scene"] for row in self.rows()], ["clinic_1"])
        self.order()
        self.assertEqual(len(self.keep("--scenes", "clinic_[1-3]")[1]), 3, "of the new programs none has been played")

    def test_a_new_figure_is_a_new_column(self):
        self.keep("--scenes", "clinic_1")
        self.order(more={"new_share": 0.5})
        self.keep("--scenes", "clinic_2")
        self.assertEqual([row["new_share"] for row in self.rows()], ["", "0.5"])
        self.assertEqual([row["lost_time_s"] for row in self.rows()], ["1", "1"])

    def test_another_table_is_refused_and_left_alone(self):
        self.table.parent.mkdir()
        self.table.write_text("scene,method\n1,2\n")
        output, played = self.keep("--scenes", "clinic_1", status=2)
        self.assertIn("no table of benchmark.sh --table", output)
        self.assertEqual((played, self.table.read_text()), ([], "scene,method\n1,2\n"))

    def test_a_world_that_is_not_there_is_refused(self):
        self.assertIn("no file that can be read", self.benchmark("--world", self.folder / "none.yaml", status=2)[0])

    def test_rows_can_be_printed_by_key_or_the_newest(self):
        def printed(*ids):
            result = subprocess.run([self.folder / "launch_scripts/benchmark_table.py", "--rows", self.table, *ids],
                                    capture_output=True, text=True)
            lines = [[cell.strip() for cell in line.split("|")[1:5]] for line in result.stdout.splitlines()[2:]]
            return result.returncode, [line[:3] for line in lines]

        self.keep("--scenes", "clinic_[1-2]")
        old = self.rows()[0]["key"]
        self.script("bin/lapis_slam", "other")
        self.keep("--scenes", "clinic_2")
        self.keep("--scenes", "flat_1", "--methods", "nearest")
        newest = [["clinic_2", "tour", "1"], ["flat_1", "nearest", "1"]]
        self.assertEqual(printed(), (0, newest))
        self.assertEqual(printed(old), (0, [["clinic_1", "tour", "1"], ["clinic_2", "tour", "1"],
                                            ["clinic_*", "tour", "median of 2"]]))
        self.assertEqual(printed(f"{old}/clinic_1"), (0, [["clinic_1", "tour", "1"]]))
        self.assertEqual(printed(f"{old}/clinic"), (1, []))

    def test_jobs_go_side_by_side_in_domains_of_their_own(self):
        self.order(meet=7)
        output, played = self.keep("--scenes", "clinic_[1-2]", "--jobs", "2")
        self.assertEqual(sorted(played), ["clinic_1/tour/1", "clinic_2/tour/1"])
        domains = [line.split()[1] for line in (self.folder / "bin/played").read_text().splitlines()]
        self.assertEqual(sorted(domains), ["7", "8"])
        self.assertEqual(sorted(row["scene"] for row in self.rows()), ["clinic_1", "clinic_2"])
        self.assertIn("| clinic_* | tour | median of 2 |", output)

    def test_many_jobs_lose_no_row(self):
        self.order(status={"clinic_5/tour/1": 1})
        self.keep("--scenes", "clinic_[1-12]", "--jobs", "3", status=1)
        self.assertEqual(sorted(int(row["scene"].removeprefix("clinic_")) for row in self.rows()), list(range(1, 13)))
        self.assertEqual([row["scene"] for row in self.rows() if row["outcome"] == "FAILED"], ["clinic_5"])

    def test_jobs_end_in_order_when_the_benchmark_is_stopped(self):
        self.order(slow=["clinic_1/tour/1", "clinic_1/tour/2"])
        ours, theirs = os.pipe()  # closed when the last process of the benchmark has ended
        process = subprocess.Popen(self.command("--scenes", "clinic_1", "--runs", "2", "--jobs", "2", "--table", self.table),
                                   env=self.environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   pass_fds=[theirs])
        os.close(theirs)
        self.addCleanup(os.close, ours)
        self.addCleanup(process.kill)
        for seed in (1, 2):
            (self.folder / f"bin/gate_{seed}").open().close()  # it has come to where it waits
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(20), 143)
        self.assertEqual(os.read(ours, 1), b"")
        self.assertEqual([(self.folder / f"bin/ended_{seed}").exists() for seed in (1, 2)], [True, True])
        self.assertFalse(self.table.exists() and self.rows())


if __name__ == "__main__":
    unittest.main(verbosity=2)
