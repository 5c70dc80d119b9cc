#!/usr/bin/env python3
"""perturb.sh on sequences that the test makes, against brute force, and its command line with a replay that only pretends.

usage: perturbation_test.py REPOSITORY
"""
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image

from pretended_programs import REPOSITORY, PretendedPrograms

sys.path.insert(0, str(REPOSITORY / "launch_scripts"))
from perturbations import kinds  # noqa: E402  (after its place is known)
from perturbations.sequence import read_sequence, write_sequence  # noqa: E402

WIDTH, HEIGHT, FOCAL, SHOTS, TURN_RAD = 64, 48, 50.0, 12, 0.1
CAMERA = f"width: {WIDTH}\nheight: {HEIGHT}\nfx: {FOCAL}\nfy: {FOCAL}\ncx: 31.5\ncy: 23.5\ndepth_scale: 1000\nfps: 30\n"


def scene():
    """Colours without a pattern, and a box in front of a wall."""
    random = np.random.default_rng(3)
    depth = np.full((HEIGHT, WIDTH), 3000, dtype=np.uint16)
    depth[10:30, 20:40] = 1500
    depth[:4] = 0
    return random.integers(30, 220, size=(HEIGHT, WIDTH, 3), dtype=np.uint8), depth


def make_sequence(folder, shots=SHOTS):
    """A camera that turns about its y axis (down: to the right) by TURN_RAD from shot to shot; its images stay the same."""
    (folder / "rgb").mkdir(parents=True)
    (folder / "depth").mkdir()
    (folder / "camera.yaml").write_text(CAMERA)
    color, depth = scene()
    lines, truth = [], []
    for i in range(shots):
        Image.fromarray(color).save(folder / f"rgb/{i}.png")
        Image.fromarray(depth).save(folder / f"depth/{i}.png")
        lines.append(f"{i / 30:.6f} rgb/{i}.png {i / 30:.6f} depth/{i}.png\n")
        truth.append(f"{i / 30:.6f} 0 0 0 0 {math.sin(i * TURN_RAD / 2)} 0 {math.cos(i * TURN_RAD / 2)}\n")
    (folder / "associations.txt").write_text("".join(lines))
    (folder / "groundtruth.txt").write_text("# stamp tx ty tz qx qy qz qw\n" + "".join(truth))
    return folder


class KindsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.sequence = read_sequence(make_sequence(self.folder / "plain"))
        self.color, self.depth = scene()

    def played(self, kind, name="changed"):
        """As written to files and read again."""
        camera, shots = kinds.KINDS[kind](self.sequence, np.random.default_rng(1))
        write_sequence(self.folder / name, self.sequence, camera, shots)
        changed = read_sequence(self.folder / name)
        return changed.camera, list(changed.shots())

    def test_every_kind_changes_what_it_names_and_is_the_same_twice(self):
        for kind in kinds.KINDS:
            with self.subTest(kind):
                camera, shots = self.played(kind)
                again = self.played(kind, "again")
                self.assertEqual(len(shots), {"7.5 Hz": SHOTS // 4, "depth late": SHOTS // 2}.get(kind, SHOTS))
                self.assertEqual(camera, again[0])
                for a, b in zip(shots, again[1]):
                    np.testing.assert_array_equal(a.color, b.color)
                    np.testing.assert_array_equal(a.depth, b.depth)
                is_color = kind in ("gamma 0.4", "gamma 2.5", "motion blur", "rolling shutter", "JPEG 60", "person")
                is_depth = kind in ("holes", "depth not registered", "person")
                self.assertEqual(not np.array_equal(shots[2].color, self.color), is_color)
                self.assertEqual(not np.array_equal(shots[2].depth, self.depth), is_depth)
                is_calibration = kind.startswith(("depth +", "depth -", "focal"))
                self.assertEqual({**camera, "fps": 30} != self.sequence.camera, is_calibration)

    def test_a_turn_to_the_right_moves_the_image_to_the_left(self):
        flows = kinds.flows_of(self.sequence)
        np.testing.assert_allclose(flows[:-1], [[-FOCAL * TURN_RAD, 0.0]] * (SHOTS - 1), rtol=1e-3, atol=1e-9)
        np.testing.assert_array_equal(flows[-1], [0.0, 0.0])

    def test_rolling_shutter_bends_what_is_upright(self):
        shots = self.played("rolling shutter")[1]
        shift = round(-kinds.READ_OUT_SHARE * (40 / HEIGHT - 0.5) * FOCAL * TURN_RAD)
        np.testing.assert_array_equal(shots[0].color[40, 10:50], self.color[40, 10 - shift:50 - shift])
        np.testing.assert_array_equal(shots[0].color[HEIGHT // 2], self.color[HEIGHT // 2])

    def test_motion_blur_keeps_the_mean_and_takes_the_edges(self):
        shot = self.played("motion blur")[1][0]
        self.assertAlmostEqual(shot.color.mean(), self.color.mean(), delta=3)
        self.assertLess(np.diff(shot.color[20].astype(float), axis=0).std(), 0.8 * np.diff(self.color[20].astype(float), axis=0).std())

    def test_depth_of_a_camera_of_its_own_against_each_point_by_itself(self):
        depth = self.played("depth not registered")[1][0].depth
        farthest = np.full(depth.shape, np.inf)
        for v, u in zip(*np.nonzero(self.depth)):
            z = self.depth[v, u] / 1000
            point = np.array([(u - 31.5) * z / FOCAL + 0.025, (v - 23.5) * z / FOCAL, z])
            at = 1.11 * FOCAL * point[:2] / z + [31.5, 23.5]
            for column in (math.floor(at[0]), math.floor(at[0]) + 1):
                for row in (math.floor(at[1]), math.floor(at[1]) + 1):
                    if 0 <= row < HEIGHT and 0 <= column < WIDTH:
                        farthest[row, column] = min(farthest[row, column], self.depth[v, u])
        np.testing.assert_array_equal(depth, np.where(np.isfinite(farthest), farthest, 0))

    def test_holes_take_a_tenth_and_flying_pixels_lie_between_near_and_far(self):
        shots = self.played("holes")[1]
        lost = np.mean([((shot.depth == 0) & (self.depth > 0)).sum() / (self.depth > 0).sum() for shot in shots])
        self.assertTrue(0.06 < lost < 0.16, lost)
        flying = np.concatenate([shot.depth[(shot.depth != self.depth) & (shot.depth > 0)] for shot in shots])
        self.assertGreater(len(flying), 100)
        self.assertTrue(((flying >= 1500) & (flying <= 3000)).all())

    def test_a_person_hides_what_is_behind_alone(self):
        shots = self.played("person")[1]
        at = kinds.PERSON_DISTANCE_M * 1000
        hidden = shots[9].depth == at
        self.assertTrue(0.05 < hidden.mean() < 0.5, hidden.mean())
        np.testing.assert_array_equal(shots[9].depth[~hidden], self.depth[~hidden])
        np.testing.assert_array_equal(shots[9].color[~hidden], self.color[~hidden])

    def test_images_that_nobody_could_track_are_found(self):
        shots = [*self.played("none")[1]]
        self.assertEqual(kinds.share_of_poor_shots(shots), 0.0)
        dark = kinds.Shot(0.0, np.zeros_like(self.color), self.depth)
        blind = kinds.Shot(0.0, self.color, np.zeros_like(self.depth))
        self.assertAlmostEqual(kinds.share_of_poor_shots([*shots, dark, blind]), 2 / (SHOTS + 2))


# In place of replay.sh: notes what was asked for, and leaves metrics.
REPLAY = """#!/usr/bin/env python3
import json, pathlib, sys
folder = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
with (pathlib.Path(__file__).parent / "played").open("a") as played:
    played.write(f"{folder.parent.name} {folder.name}\\n")
if folder.name == "holes":
    sys.exit(1)
folder.mkdir()
(folder / "metrics.json").write_text(json.dumps({"frames_total": 12, "frames_tracked": 9, "ate_se3_rmse_m": 0.02,
                                                 "cpu_ms_per_frame": {"slam": 5.0}}))
"""


class CommandTest(PretendedPrograms):
    def setUp(self):
        super().setUp()
        for file in ("CMakeLists.txt", "CMakePresets.json"):
            (self.folder / file).write_text("of all\n")
        self.script("launch_scripts/replay.sh", REPLAY)
        self.sequence = make_sequence(self.folder / "walk")
        self.rows = self.folder / "rows.csv"

    def run_it(self, *arguments):
        return subprocess.run([self.folder / "launch_scripts/perturb.sh", *arguments, "--results", self.rows, "--out",
                               self.folder / "out"], env=self.environment(), capture_output=True, text=True, check=False)

    def played(self):
        file = self.folder / "launch_scripts/played"
        return file.read_text().splitlines() if file.exists() else []

    def test_rows_are_kept_failures_are_said_and_what_has_a_row_is_not_repeated(self):
        first = self.run_it(self.sequence, "--kinds", "none, holes, depth +3 %")
        self.assertEqual(first.returncode, 1, first.stderr)
        self.assertIn("walk, holes: replay.sh failed with status 1, log", first.stderr)
        self.assertIn("| walk | depth +3 % | 12 | 75.0 % | 2.00 cm | 1.00 | 5.0 ms | 1.00 |  |", first.stdout)
        self.assertEqual(len(self.played()), 3)
        second = self.run_it(self.sequence, "--kinds", "none,depth +3 %")
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertEqual(len(self.played()), 3)
        (self.folder / "components/new.cpp").write_text("// another one\n")
        self.run_it(self.sequence, "--kinds", "none")
        self.assertEqual(len(self.played()), 4, "of other sources")
        self.assertEqual(self.run_it(self.sequence, "--table").returncode, 0)
        self.assertEqual(len(self.played()), 4)

    def test_wrong_words_are_refused(self):
        for arguments, words in (((self.sequence, "--kinds", "fog"), "--kinds: no such kind: fog"),
                                 ((self.folder / "nowhere",), "wanted is a sequence with camera.yaml and associations.txt")):
            result = self.run_it(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(words, result.stderr)
        self.assertEqual(self.played(), [])


if __name__ == "__main__":
    unittest.main()
