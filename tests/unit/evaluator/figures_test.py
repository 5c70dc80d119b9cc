#!/usr/bin/python3
"""figures.py on made-up runs: all figures, and a clear word about each missing file."""
import json
import math
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(sys.argv.pop(1))
ALL = {"trajectory.png", "errors.png", "class_iou.png"}


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
    path.write_text(json.dumps({"iou_top8_mean": 0.585, "iou_by_class": classes}))


class Figures(unittest.TestCase):
    def setUp(self):
        self.run_folder = Path(tempfile.mkdtemp()) / "a_run"
        self.run_folder.mkdir()
        write_trajectory(self.run_folder / "trajectory_estimate.txt", 1)
        write_trajectory(self.run_folder / "trajectory_ground_truth.txt", 0)
        write_map(self.run_folder / "map.ply")
        write_metrics(self.run_folder / "metrics.json")

    def tearDown(self):
        shutil.rmtree(self.run_folder.parent)

    def draw(self):
        result = subprocess.run([sys.executable, SCRIPT, self.run_folder], capture_output=True, text=True, check=False)
        self.assertNotIn("Traceback", result.stderr)
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
        for name, kept in (("map.ply", ALL), ("trajectory_ground_truth.txt", ALL - {"errors.png"}),
                           ("trajectory_estimate.txt", {"class_iou.png"}), ("metrics.json", ALL - {"class_iou.png"})):
            with self.subTest(name):
                self.tearDown()
                self.setUp()
                (self.run_folder / name).unlink()
                result, drawn = self.draw()
                self.assertEqual((result.returncode, drawn), (0, kept))
                self.assertIn(name, result.stderr)

    def test_damaged_files_are_no_crash(self):
        for name in ("trajectory_estimate.txt", "trajectory_ground_truth.txt", "map.ply", "metrics.json"):
            path = self.run_folder / name
            path.write_bytes(path.read_bytes()[: path.stat().st_size // 2 - 3])
        result, drawn = self.draw()
        self.assertNotIn("class_iou.png", drawn)
        self.assertIn("metrics.json", result.stderr)

    def test_no_folder_and_nothing_to_draw(self):
        for path in self.run_folder.iterdir():
            path.unlink()
        self.assertEqual(self.draw()[0].returncode, 1)
        self.run_folder = self.run_folder.parent / "absent"
        self.assertEqual(self.draw()[0].returncode, 2)
        (self.run_folder.parent / "a_run").mkdir(exist_ok=True)


if __name__ == "__main__":
    unittest.main()
