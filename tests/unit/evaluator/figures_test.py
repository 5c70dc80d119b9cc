#!/usr/bin/python3
"""Figures of made-up runs: all of them, and a clear word about each missing file."""
import contextlib
import importlib
import io
import json
import math
import shutil
import struct
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

import numpy

SCRIPT = Path(sys.argv.pop(1))
OF_MAP = {"map.png", "map_error.png", "beside_truth.png"}
ALL = OF_MAP | {"trajectory.png", "pose_graph.png", "coverage.png", "errors.png", "class_iou.png", "decision.png",
                "progress.png"}
FROM_ESTIMATE = OF_MAP | {"trajectory.png", "errors.png", "decision.png"}
sys.path.insert(0, str(SCRIPT.parent))


def write_trajectory(path, drift):
    lines = ["# timestamp tx ty tz qx qy qz qw"]
    for i in range(200):
        turn = 2 * math.pi * i / 200
        x, y = 3 * math.sin(turn), 2 - 2 * math.cos(turn)
        half = (turn + 0.0002 * i * drift) / 2
        lines.append(f"{i / 10:.9f} {x + 0.001 * i * drift} {y} 1 0 0 {math.sin(half)} {math.cos(half)}")
    path.write_text("\n".join(lines) + "\n")


def write_map(path):
    points = [(x * 0.25, y * 0.25, z * 0.25) for x in range(-20, 21) for y in range(-6, 26) for z in (0, 1, 9)
              if z != 1 or x in (-20, 20) or y in (-6, 25) or (5 < x < 12 and 14 < y < 18)]
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
              + "".join(f"property float {a}\n" for a in "xyz")
              + "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
              + "property ushort label\nproperty float probability\nend_header\n")
    colours = {0.0: (170, 140, 90), 0.25: (40, 110, 180), 2.25: (255, 0, 0)}
    body = b"".join(struct.pack("<fffBBBHf", *p, *colours[p[2]], 1, 0.9) for p in points)
    path.write_bytes(header.encode() + body)


def write_metrics(path):
    names = ["wall", "floor", "cabinet", "chair", "sofa", "table", "bed", "window", "door", "picture"]
    classes = {n: {"iou": max(0.0, 0.9 - 0.09 * i), "tolerant_iou": 0.9, "reference_voxels": 5000 // (i + 1),
                   "estimate_voxels": 10, "top8": i < 8} for i, n in enumerate(names)}
    path.write_text(json.dumps({"iou_top8_mean": 0.585, "loop_closures": 1, "iou_by_class": classes}))


def write_pose_graph(path):
    lines = [f"VERTEX_SE3:QUAT {i} {0.1 * i} {0.01 * i * i} 1 0 0 0 1" for i in range(30)]
    lines += [f"EDGE_SE3:QUAT {i} {j} 0 0 0 0 0 0 1 " + "1 " * 21
              for i, j in [(k, k + 1) for k in range(29)] + [(2, 20), (3, 25)]]
    path.write_text("\n".join(lines) + "\n")


def write_timeline(path):
    rows = [f"{t},{0.5 * t},{0.005 * t if t > 5 else ''},{0.005 * t if t > 5 else ''},{0.2 * t},0.01,0.02,TRACKING,"
            f"{'EXPLORING' if t < 150 else 'GAVE_UP'},{int(60 < t <= 90)}" for t in range(190)]
    path.write_text("time_s,explored_volume_m3,explored_share,explored_share_with_margin,path_length_m,position_error_m,"
                    "position_sigma_m,state,planner_state,is_stalled\n" + "\n".join(rows) + "\n")


def write_frames(path, tier=lambda i: "vision" if i < 100 else "odometry"):
    rows = [f"{i / 10},{tier(i)},{0.02 * i},{'' if tier(i) == 'none' else 0.01},{'' if tier(i) == 'none' else 0.002}"
            for i in range(200)]
    path.write_text("time_s,tier,path_length_m,position_sigma_m,position_error_m\n" + "\n".join(rows) + "\n")


def write_plan(path, decision):
    """A room of 4 by 3 cells with a frontier, and as many paths as decision 2 has candidates."""
    path.write_text(json.dumps({
        "decision": decision, "robot_m": [0.0, 0.0], "resolution_m": 0.25, "frontiers": [{"id": 1, "cells_m": [[0.1, 0.1]]}],
        "plan": {"lower_left_m": [-0.5, -0.5], "rows": ["####", "#..#", "#. #"]},
        "paths_m": [[[0.0, 0.0], [float(c), 2.0]] for c in range(3)] + [[]]}))


def write_decisions(path):
    """Decision 2 has most candidates, one of which is rejected, but decision 1 has as many that are not."""
    header = "decision,time_s,method,candidate,x_m,y_m,yaw_rad,cost_m,path_information_nats,d_optimality,utility," \
             "is_chosen,is_chosen_by_mi_only,rejection"
    rows = [f"{d},{5 * d}.0,lapis,{c},{c},{d},0.5,{1 + c},{100 - c},1.5,{0 if d == 2 and c == 3 else 2.5 - c},"
            f"{int(c == 0)},{int(c == 1)},{'no path' if d == 2 and c == 3 else ''}"
            for d, count in ((1, 3), (2, 4), (3, 1)) for c in range(count)]
    path.write_text("\n".join([header, *rows]) + "\n")


def module(name):
    return importlib.import_module(f"lapis_figures.{name}")


def write_pretended_mapper(folder):
    """A map file is converted to points by copying it."""
    tool = folder / "lapis_semantic_mapper"
    tool.write_text('#!/bin/sh\n[ "$1" = convert ] && cp "$2" "$3"\n')
    tool.chmod(0o755)


class Figures(unittest.TestCase):
    def setUp(self):
        self.run_folder = Path(tempfile.mkdtemp()) / "a_run"
        self.run_folder.mkdir()
        write_pretended_mapper(self.run_folder.parent)
        module("inputs").PROGRAMS = self.run_folder.parent
        write_map(self.run_folder / "reference_map.lapis")
        write_trajectory(self.run_folder / "trajectory_estimate.txt", 1)
        write_trajectory(self.run_folder / "trajectory_ground_truth.txt", 0)
        write_map(self.run_folder / "map.ply")
        write_metrics(self.run_folder / "metrics.json")
        write_pose_graph(self.run_folder / "pose_graph.g2o")
        write_timeline(self.run_folder / "timeline.csv")
        write_frames(self.run_folder / "frames.csv")
        write_decisions(self.run_folder / "decisions.csv")

    def tearDown(self):
        shutil.rmtree(self.run_folder.parent)

    def draw_unsaved(self):
        """The same, but names of figures are all that it leaves: writing them takes the most time."""
        def touch(figure, folder, name, _):
            module("style").plt.close(figure)
            (folder / f"{name}.png").touch()

        with mock.patch.object(importlib.import_module(SCRIPT.stem), "save", touch):
            return self.draw()

    def draw(self, *options):
        """What the script returns, with what it said, and what it has drawn."""
        errors = io.StringIO()
        with mock.patch.object(sys, "argv", [str(SCRIPT), str(self.run_folder), *options]), \
                contextlib.redirect_stderr(errors):
            result = types.SimpleNamespace(returncode=importlib.import_module(SCRIPT.stem).main(), stderr=errors.getvalue())
        drawn = {p.name for p in (self.run_folder / "figures").glob("*")} if self.run_folder.is_dir() else set()
        return result, drawn

    def test_whole_run_gives_all_figures_and_the_same_bytes_twice(self):
        result, drawn = self.draw()
        self.assertEqual((result.returncode, result.stderr, drawn), (0, "", ALL))
        before = {name: (self.run_folder / "figures" / name).read_bytes() for name in ALL}
        self.draw()
        for name in ALL:
            self.assertEqual((self.run_folder / "figures" / name).read_bytes(), before[name])

    def test_each_missing_file_is_named_and_the_rest_is_drawn(self):
        for names, kept in ((("map.ply",), ALL - OF_MAP),
                            (("trajectory_estimate.txt",), ALL - FROM_ESTIMATE),
                            (("trajectory_ground_truth.txt", "metrics.json", "pose_graph.g2o", "timeline.csv"),
                             OF_MAP | {"trajectory.png", "decision.png", "progress.png"}),
                            (("reference_map.lapis",), {*ALL} - {"map_error.png", "beside_truth.png"}),
                            (("frames.csv",), ALL - {"progress.png"})):
            with self.subTest(names):
                self.tearDown()
                self.setUp()
                for name in names:
                    (self.run_folder / name).unlink()
                result, drawn = self.draw_unsaved()
                self.assertEqual((result.returncode, drawn), (0, kept))
                for name in names:
                    self.assertRegex(result.stderr, f"{name} is missing|is missing, and so are .*{name}")

    def test_formats_and_names_are_chosen(self):
        result, drawn = self.draw("--only", "map", "coverage", "--formats", "svg", "pdf")
        self.assertEqual((result.returncode, drawn), (0, {f"{name}.{ending}" for name in ("map", "coverage")
                                                          for ending in ("svg", "pdf")}))

    def test_the_error_of_a_voxel_is_its_distance_to_the_nearest_of_the_reference(self):
        distances = module("against_truth").distances
        reference = numpy.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
        positions = numpy.array([[0.0, 0.0, 0.0], [0.25, 0.25, 0.0], [0.75, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.0, 5.0]])
        expected = [0.0, 0.25 * 2**0.5, 0.25, 0.5, 0.5]  # at most two cells
        numpy.testing.assert_allclose(distances(positions, reference, 0.25), expected)
        some = numpy.random.default_rng(1).integers(0, 12, (2, 60, 3)) * 0.25
        exact = numpy.linalg.norm(some[0][:, None] - some[1][None], axis=2).min(axis=1)
        numpy.testing.assert_allclose(distances(*some, 0.25), numpy.minimum(exact, 0.5))

    def test_the_map_is_compared_with_the_whole_building_where_a_run_has_it(self):
        (self.run_folder / "ground_truth").mkdir()
        titles = []
        figures = module("against_truth")
        metrics = json.loads((self.run_folder / "metrics.json").read_text())
        (self.run_folder / "metrics.json").write_text(json.dumps(metrics | {"full_map_error_mean_m": 1.234}))
        for name in ("ideal", "full"):
            write_map(self.run_folder / f"ground_truth/{name}.lapis")
            figure = figures.draw_map_error(self.run_folder)
            titles.append(figure.axes[0].get_title().partition("\n")[2])
            figures.plt.close(figure)
        self.assertEqual(titles, ["reference: the same frames without noise at true poses",
                                  "mean of the whole map 123.4 cm; reference: the whole building"])

    def test_pose_graph_counts_as_loops_what_the_metrics_call_loops(self):
        figures = module("plans")

        def legend():
            figure = figures.draw_pose_graph(self.run_folder)
            texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
            figures.plt.close(figure)
            return texts

        nodes, neighbours = "30 key-frames", "29 edges between neighbours in time"
        self.assertEqual(legend(), [nodes, neighbours, "2 other edges\n(loop closures: 1)"])
        for text in ('{"loop_closures": null}', "{}", "[]", "{"):
            (self.run_folder / "metrics.json").write_text(text)
            self.assertEqual(legend(), [nodes, neighbours, "2 other edges"])
        (self.run_folder / "metrics.json").unlink()
        self.assertEqual(legend(), [nodes, neighbours, "2 other edges"])

    def test_stretches_of_a_tier_are_weighed_as_the_shares_are(self):
        seconds, tiers = [1.0, 2.0, 4.0, 4.5, 5.0], ["vision", "vision", "odometry", "none", "vision"]
        self.assertEqual(module("progress").stretches(seconds, tiers, 7.0), [
            ("none", 0.0, 1.0), ("vision", 1.0, 2.0), ("odometry", 2.0, 4.0), ("none", 4.0, 4.5), ("vision", 4.5, 5.0),
            ("none", 5.0, 7.0)])
        self.assertEqual(module("progress").stretches([0.0, 1.0], ["none", "none"], 1.0), [("none", 0.0, 1.0)])

    def test_progress_says_what_held_the_pose_and_for_how_long(self):
        figures = module("progress")
        write_frames(self.run_folder / "frames.csv", lambda i: "surfaces" if 0 < i < 50 else "vision")
        figure = figures.draw_progress(self.run_folder)
        texts = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
        self.assertEqual(texts, ["vision 75.4 %", "surfaces 24.6 %", "odometry 0.0 %", "no pose 0.0 %"])  # 4.9 of 19.9 s
        figures.plt.close(figure)

    def test_progress_names_stretches_without_it_and_what_the_planner_did(self):
        figures = module("progress")
        figure = figures.draw_progress(self.run_folder)
        self.assertEqual([text.get_text() for text in figure.axes[0].texts], ["no progress\n30 s"])
        self.assertEqual([text.get_text() for text in figure.axes[2].get_legend().get_texts()], ["EXPLORING", "GAVE_UP"])
        self.assertEqual(figure.axes[4].get_ylabel(), "explored [%]")
        figures.plt.close(figure)
        for rows in (["time_s,explored_volume_m3", "0,1", "1,2"], None):  # of a recording, and none
            if rows:
                (self.run_folder / "timeline.csv").write_text("\n".join(rows) + "\n")
            else:
                (self.run_folder / "timeline.csv").unlink()
            figure = figures.draw_progress(self.run_folder)
            self.assertEqual(len(figure.axes), 4)
            self.assertFalse(figure.axes[2].get_visible())
            figures.plt.close(figure)

    def test_progress_of_a_run_that_never_began_and_of_one_without_truth(self):
        write_frames(self.run_folder / "frames.csv", lambda i: "none")
        self.assertEqual(self.draw_unsaved()[1], ALL)
        rows = ["time_s,tier,path_length_m,position_sigma_m,position_error_m"]
        rows += [f"{i / 10},vision,,0.01," for i in range(200)]
        (self.run_folder / "frames.csv").write_text("\n".join(rows) + "\n")
        figure = module("progress").draw_progress(self.run_folder)
        self.assertIn("path by the estimate", figure.axes[0].get_ylabel())
        self.assertGreater(figure.axes[0].lines[0].get_ydata()[-1], 10.0)  # once round an ellipse with axes of 6 and 4 m
        module("style").plt.close(figure)

    def test_a_method_that_asks_for_nothing_has_no_bars_of_it(self):
        decisions = self.run_folder / "decisions.csv"
        rows = [line.split(",") for line in decisions.read_text().splitlines()]
        for row in rows[1:]:
            row[8] = row[9] = ""  # information and D-optimality
        decisions.write_text("\n".join(",".join(row[:12] + row[13:]) for row in rows) + "\n")  # nor is it compared
        result, drawn = self.draw_unsaved()
        self.assertEqual((result.returncode, result.stderr, drawn), (0, "", ALL))
        figure = module("decision").draw_decision(self.run_folder)
        self.assertEqual([axes.get_title() for axes in figure.axes[1:]], ["utility", "cost [m]"])
        module("style").plt.close(figure)

    def test_a_decision_is_shown_with_what_was_known_then(self):
        figures = module("decision")

        def title_and_plan():
            figure = figures.draw_decision(self.run_folder)
            figures.plt.close(figure)
            images = figure.axes[0].get_images()
            return figure._suptitle.get_text().split()[1], [image.get_array().shape for image in images], figure.axes[0].lines

        number, images, lines = title_and_plan()
        self.assertEqual((number, images), ("1", []))  # a folder from before the file
        write_plan(self.run_folder / "decision.json", 2)
        number, images, more_lines = title_and_plan()
        self.assertEqual((number, images), ("2", [(3, 4)]))
        self.assertEqual(len(more_lines), len(lines) + 1 + 3 + 1)  # frontiers, paths, the rejected candidate
        write_plan(self.run_folder / "decision.json", 99)
        with self.assertRaisesRegex(figures.MissingInput, "decision.json is damaged"):
            figures.draw_decision(self.run_folder)
        (self.run_folder / "decision.json").write_text("{")
        with self.assertRaisesRegex(figures.MissingInput, "decision.json is damaged"):
            figures.draw_decision(self.run_folder)

    def test_a_run_without_a_planner_has_no_figure_of_a_decision(self):
        (self.run_folder / "decisions.csv").unlink()
        result, drawn = self.draw_unsaved()
        self.assertEqual((result.returncode, result.stderr, drawn), (0, "", ALL - {"decision.png"}))

    def test_a_full_disk_leaves_no_part_of_a_figure(self):
        (self.run_folder / "figures").mkdir()
        for name in ALL:
            (self.run_folder / f"figures/{name}.part").symlink_to("/dev/full")
        result, drawn = self.draw()
        self.assertEqual((result.returncode, drawn), (1, set()))
        self.assertIn("map cannot be written: No space left on device", result.stderr)

    def test_damaged_files_are_no_crash(self):
        for path in list(self.run_folder.iterdir()):
            path.write_bytes(path.read_bytes()[: path.stat().st_size // 2 - 3])
        result, drawn = self.draw_unsaved()
        self.assertNotIn("class_iou.png", drawn)
        self.assertIn("metrics.json", result.stderr)

    def test_as_a_program(self):
        command = [sys.executable, SCRIPT, self.run_folder, "--only", "coverage"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        result = subprocess.run([*command, "--formats", "gif"], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("invalid choice: 'gif'", result.stderr)

    def test_no_folder_and_nothing_to_draw(self):
        for path in self.run_folder.iterdir():
            path.unlink()
        self.assertEqual(self.draw()[0].returncode, 1)
        self.run_folder = self.run_folder.parent / "absent"
        self.assertEqual(self.draw()[0].returncode, 2)
        (self.run_folder.parent / "a_run").mkdir(exist_ok=True)


if __name__ == "__main__":
    unittest.main()
