#!/usr/bin/env python3
"""explore.sh: in a flat of two rooms, and, as a test of its own that takes minutes, in a bundled building. Without the
furniture package, so that it is the same everywhere."""
import collections
import contextlib
import csv
import json
import math
import os
import re
import signal
import struct
import subprocess

import chain

COMPONENTS = ("slam", "semantic_mapper", "planner", "controller", "evaluator", "simulator")
FILES = chain.FILES + chain.FILES_OF_LABELS + chain.FILES_OF_TRUTH + ("decisions.csv", "figures/decision.png")
SENSING_RANGE_M = 5.0  # robot.sensing_range_m
VOXEL_M = 0.25  # semantic_mapper.resolution_m


def explore(out, *options):
    """launch_scripts/explore.sh, started."""
    return chain.Process([chain.REPOSITORY / "launch_scripts/explore.sh", "--out", out, *options], f"{out}.log")


def table(file):
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


class ExploreCase(chain.ChainTest):
    def write_flat(self):
        scene = self.folder / "flat.yaml"
        scene.write_text(chain.FLAT, encoding="utf-8")
        return scene

    def explore(self, name, *options):
        """Explores to the end, demands success and returns the run folder."""
        out = self.folder / name
        with explore(out, *options) as run:
            self.assertEqual(run.wait(170), 0, run.output())
            self.assert_no_orphan(run)
            self.assertRegex(run.output(), r"(?m)^\d+ s, \d+ m3 explored \(\d+\.\d %\), [\d.]+ m driven, loops closed: ")
        return out

    def assert_files(self, folder, files=FILES):
        for file in (*files, "manifest.yaml", "metrics.json", *(f"logs/{name}.log" for name in COMPONENTS)):
            self.assertTrue((folder / file).is_file() and (folder / file).stat().st_size > 0, file)
        self.assertEqual(list(folder.rglob("*.part*")), [])
        self.assertTrue(chain.is_map_whole(folder / "map.lapis"))

    def assert_decisions(self, folder):
        """Every decision has its rows, and one of them is chosen unless none can be driven to."""
        decisions = collections.defaultdict(list)
        for row in table(folder / "decisions.csv"):
            decisions[int(row["decision"])].append(row)
        reported = chain.metrics_of(folder)["decisions"]
        self.assertGreater(reported, 5)
        self.assertLessEqual(max(decisions), reported)
        for number, rows in decisions.items():
            self.assertEqual([int(row["candidate"]) for row in rows], list(range(len(rows))), number)
            possible = [row for row in rows if not row["rejection"]]
            self.assertEqual(sum(row["is_chosen"] == "1" for row in rows), 1 if possible else 0, number)

    # The folders have the same last name, because a figure has it in its title.
    def explore_twice(self, *options):
        """Explores twice and demands the same bytes; returns a run folder and its metrics."""
        first, second = (self.explore(name, *options) for name in ("first/run", "second/run"))
        self.assert_files(first)
        self.assert_decisions(first)
        self.assert_same_run(first, second, FILES)
        metrics = chain.metrics_of(first)
        self.assertEqual((metrics["exit_reason"], metrics["planner_state"]), ("completed", "EXPLORING"))
        self.assertEqual(metrics["collisions"], 0)
        return first, metrics


class LongExploreTest(ExploreCase):
    def test_the_robot_explores_and_the_same_seed_gives_the_same_bytes(self):
        first, metrics = self.explore_twice("--duration", "25", "--seed", "3", *chain.NO_FURNITURE)
        self.assertEqual(set(metrics["cpu_ms_per_frame"]), set(COMPONENTS))
        self.assertEqual([name for name, value in metrics["cpu_ms_per_frame"].items() if value is None], [])
        self.assertGreater(metrics["decision_time_p95_s"], 0.0)
        # What is farther from the start than the camera sees cannot be seen by turning there.
        seen = [math.hypot(x, y) for x, y in self.explored_places(first)]
        self.assertGreater(max(seen), SENSING_RANGE_M + 2 * VOXEL_M)
        rows = table(first / "timeline.csv")
        self.assertEqual({row["planner_state"] for row in rows[2:]}, {"EXPLORING"})
        self.assertEqual([row["time_s"] for row in rows if not row["position_sigma_m"]], [])
        shares = [float(row["explored_share"]) for row in rows]
        self.assertGreater(shares[-1], 2 * shares[0])

    def explored_places(self, folder):
        """x and y of the occupied voxels of map.ply, whose vertices have 3 floats, 3 bytes, a short and a float."""
        head, _, body = (folder / "map.ply").read_bytes().partition(b"end_header\n")
        self.assertIn(b"property ushort label", head)
        return [vertex[:2] for vertex in struct.iter_unpack("<fffBBBHf", body)]

    def test_by_the_wall_clock_it_ends_when_the_time_is_up(self):
        folder = self.explore("run", *chain.NO_FURNITURE, "--freerun", "--duration", "20")
        self.assert_files(folder)
        metrics = chain.metrics_of(folder)
        self.assertEqual((metrics["planner_state"], metrics["collisions"]), ("EXPLORING", 0))
        self.assertGreater(metrics["duration_s"], 15.0)
        self.assertGreater(metrics["decisions"], 0)


class ExploreTest(ExploreCase):
    def test_the_same_seed_gives_the_same_bytes(self):
        self.explore_twice("--scene", self.write_flat(), "--duration", "10", "--seed", "3")

    def test_commands_stand_for_the_odometry_of_a_robot_that_measures_no_motion(self):
        first, metrics = self.explore_twice(
            "--scene", self.write_flat(), "--duration", "10", "--seed", "3",
            "--robot", chain.REPOSITORY / "config/robot_without_odometry", "--set", "simulator.wheels.turn_error=0.1")
        self.assertNotRegex((first / "logs/slam.log").read_text(), "odometry dropped|refused")
        self.assertLess(metrics["lost_share"], 0.02)

    def test_a_recorded_decision_is_made_again_as_it_was(self):
        folder = self.explore("run", "--scene", self.write_flat(), "--duration", "8",
                              "--set", "planner.record_situations_every=3")
        chosen = {row["decision"]: row for row in table(folder / "decisions.csv") if row["is_chosen"] == "1"}
        numbers = [file.stem for file in folder.glob("situations/*.lapis") if file.stem in chosen]
        self.assertGreaterEqual(len(numbers), 2)
        for number in numbers:
            again = self.folder / f"again_{number}"
            again.mkdir()
            subprocess.run([chain.BIN / "lapis_planner", "--config", chain.REPOSITORY / "config/robot.yaml", "--replay",
                            folder / f"situations/{number}.lapis", "--set", f"planner.output_dir={again}"],
                           check=True, capture_output=True)
            replayed = next(row for row in table(again / "replayed.csv") if row["is_chosen"] == "1")
            for column in ("kind", "x_m", "y_m", "yaw_rad", "cost_m", "path_information_nats", "d_optimality", "utility"):
                self.assertEqual(replayed[column], chosen[number][column], f"{column} of decision {number}")

    def test_done_when_nothing_is_left(self):
        folder = self.explore("run", "--scene", self.write_flat(), "--method", "nearest", "--duration", "120",
                              "--set", "simulator.full_map=true")
        manifest = (folder / "manifest.yaml").read_text()
        self.assertIn("  planner_state: DONE\n  planner_reason: \"nothing is left that can be reached", manifest)
        metrics = chain.metrics_of(folder)
        self.assertEqual((metrics["exit_reason"], metrics["planner_state"]), ("completed", "DONE"))
        self.assertGreater(metrics["explored_share"], 0.75)
        self.assertLess(metrics["duration_s"], 119.0)
        self.assert_figures(folder, "map.lapis", metrics, "full_")
        self.assert_figures(folder, "reference_map.lapis", metrics, "floor_")

    def assert_figures(self, folder, estimate, metrics, prefix):
        """Those by the map of the whole building are what the tool prints for the files."""
        files = "--reference", folder / "ground_truth/full.lapis", "--estimate", folder / estimate, "--json"
        judged = json.loads(subprocess.check_output([chain.BIN / "lapis_evaluator", "map", *files]))
        for key in ("map_error_mean_m", "map_error_p95_m", "map_completeness_mean_m"):
            self.assertEqual(metrics[prefix + key], judged[key], key)
        self.assertGreater(metrics[prefix + "iou_top8_mean"], 0.3)

    def test_an_interrupted_run_has_all_that_a_whole_one_has(self):
        run = explore(self.folder / "run", "--scene", self.write_flat(), "--method", "mi_only")
        self.addCleanup(run.kill)
        driven = re.compile(r" [1-9]\d*\.\d m driven, .* EXPLORING: ")
        self.assertTrue(run.wait_for(lambda lines: any(driven.search(line) for line in lines), 90), run.output())
        self.assertEqual(run.press_ctrl_c(10), 130, run.output())
        self.assert_no_orphan(run)
        self.assert_files(self.folder / "run", [file for file in FILES if not file.startswith("figures/")])
        self.assertEqual(chain.metrics_of(self.folder / "run")["exit_reason"], "stopped")
        self.assertIn("  planner: 0\n", (self.folder / "run/manifest.yaml").read_text())

    def test_what_the_planner_refuses_is_bad_set_up(self):
        with explore(self.folder / "run", "--method", "no_such_method") as run:
            self.assertEqual(run.wait(), 2, run.output())
            self.assertIn("planner.method", run.output())
            self.assert_no_orphan(run)


class SegmentedExploreCase(ExploreCase):
    """Labels by a network: here the nearest of three colours."""

    def model(self):
        return chain.color_model(self.folder / "model", (160, 90), ((200, 190, 170), (120, 80, 50), (40, 40, 40)),
                                 {0: "wall", 1: "floor", 2: "door"}, chain.REPOSITORY / "config/labels/mpcat40.yaml")

    def assert_labels(self, folder):
        """The map's points have the classes of the network."""
        head, _, body = (folder / "map.ply").read_bytes().partition(b"end_header\n")
        self.assertIn(b"property ushort label", head)
        labels = collections.Counter(vertex[6] for vertex in struct.iter_unpack("<fffBBBHf", body))
        self.assertGreater(sum(labels[i] for i in (1, 2, 4)), 100)
        self.assertLessEqual(set(labels), {0, 1, 2, 4})


class SegmentedExploreTest(SegmentedExploreCase):
    def test_in_lock_step_every_image_is_labelled(self):
        folder = self.explore("run", "--scene", self.write_flat(), "--duration", "5", "--segmenter", self.model())
        self.assert_labels(folder)
        self.assertGreater(chain.metrics_of(folder)["decisions"], 0)
        log = (folder / "logs/segmenter.log").read_text()
        images = int(re.findall(r"(\d+) images labelled", log)[-1])
        self.assertGreaterEqual(images, chain.metrics_of(folder)["frames_total"])
        self.assertNotRegex(log, "dropped: (?!stamp was there before)|replaced")  # a tick may come again
        self.assertGreater(chain.metrics_of(folder)["cpu_ms_per_frame"]["segmenter"], 0.0)


class LongSegmentedExploreTest(SegmentedExploreCase):
    # A network that takes a second per image: it gets its CPU for a tenth of each second only.
    def test_by_the_wall_clock_the_robot_drives_although_labels_come_late(self):
        out = self.folder / "run"
        with explore(out, "--scene", self.write_flat(), "--duration", "20", "--freerun", "--segmenter", self.model()) as run:
            while run.is_alive():
                self.pause_segmenter(run, 0.9)
                run.wait_for(lambda _: False, 0.1)  # or its end
            self.assertEqual(run.wait(), 0, run.output())
            self.assert_no_orphan(run)
        self.assert_labels(out)
        metrics = chain.metrics_of(out)
        self.assertGreater(metrics["path_length_m"], 2.0)
        late = re.findall(r"stands still: no map", (out / "logs/controller.log").read_text())
        print(f"figure: {metrics['path_length_m']:.1f} m driven, {len(late)} stops because the map was old")

    def pause_segmenter(self, run, seconds):
        for pid, program in chain.processes_of(run.run).items():
            if program == "lapis_segmenter":
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGSTOP)
                    run.wait_for(lambda _: False, seconds)
                    os.kill(pid, signal.SIGCONT)


if __name__ == "__main__":
    chain.main()
