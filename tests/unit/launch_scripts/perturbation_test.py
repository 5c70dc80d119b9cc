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
from perturbations.sequence import SequenceError, read_sequence, write_sequence  # noqa: E402

WIDTH, HEIGHT, FOCAL, RATE_HZ, SHOTS = 64, 48, 50.0, 8, 32
TURN_RAD = np.array([0.06, 0.1, 0.0])  # from shot to shot: to look up and to the right, in the camera's frame (x right, y down)
CAMERA = {"width": WIDTH, "height": HEIGHT, "fx": FOCAL, "fy": FOCAL, "cx": 31.5, "cy": 23.5, "depth_scale": 1000,
          "fps": RATE_HZ}


def color_of_all():
    return np.random.default_rng(3).integers(30, 220, size=(HEIGHT, WIDTH, 3), dtype=np.uint8)


def depth_of(shot):
    """A box before a wall, something near at the lower edge, and nothing measured at the upper one; the wall goes away."""
    depth = np.full((HEIGHT, WIDTH), 3000 + shot, dtype=np.uint16)
    depth[10:30, 20:40] = 1500
    depth[40:] = 1000
    depth[:4] = 0
    return depth


def quaternion(turn):
    """Of so many turns."""
    angle = turn * np.linalg.norm(TURN_RAD)
    return *(math.sin(angle / 2) * TURN_RAD / np.linalg.norm(TURN_RAD)), math.cos(angle / 2)


def make_sequence(folder, shots=SHOTS, camera=None, with_truth=True):
    (folder / "rgb").mkdir(parents=True)
    (folder / "depth").mkdir()
    (folder / "camera.yaml").write_text("".join(f"{key}: {value}\n" for key, value in (camera or CAMERA).items()))
    lines, truth = [], ["# stamp tx ty tz qx qy qz qw\n"]
    for i in range(shots):
        stamp = i / RATE_HZ
        Image.fromarray(color_of_all()).save(folder / f"rgb/{i}.png")
        Image.fromarray(depth_of(i)).save(folder / f"depth/{i}.png")
        lines.append(f"{stamp:.6f} rgb/{i}.png {stamp:.6f} depth/{i}.png\n")
        truth.append(f"{stamp:.6f} 0 0 0 " + " ".join(f"{q:.12f}" for q in quaternion(i)) + "\n")
    (folder / "associations.txt").write_text("".join(lines))
    if with_truth:
        (folder / "groundtruth.txt").write_text("".join(truth))
    return folder


class InAFolder(unittest.TestCase):
    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class KindsTest(InAFolder):
    def setUp(self):
        super().setUp()
        self.sequence = read_sequence(make_sequence(self.folder / "plain"))
        self.color = color_of_all()

    def played(self, kind, name="changed"):
        """camera.yaml and shots as written to files and read again."""
        camera, shots = kinds.KINDS[kind](self.sequence, np.random.default_rng(1))
        write_sequence(self.folder / name, self.sequence, camera, shots)
        changed = read_sequence(self.folder / name, fewest=1)
        return changed.camera, list(changed.shots())

    def test_every_kind_is_the_same_twice_and_leaves_alone_what_it_does_not_name(self):
        of_color = ("gamma 0.4", "gamma 2.5", "exposure jumps", "motion blur", "rolling shutter", "JPEG 60", "person")
        of_depth = ("holes", "depth not registered", "own depth camera", "person")
        for kind in kinds.KINDS:
            with self.subTest(kind):
                camera, shots = self.played(kind)
                again = self.played(kind, "again")
                self.assertEqual(camera, again[0])
                for a, b in zip(shots, again[1]):
                    np.testing.assert_array_equal(a.color, b.color)
                    np.testing.assert_array_equal(a.depth, b.depth)
                if kind not in of_color:
                    np.testing.assert_array_equal(shots[3].color, self.color)
                if kind not in (*of_depth, "depth late", "every second"):
                    np.testing.assert_array_equal(shots[3].depth, depth_of(3))
                if len(shots) == SHOTS and kind[:6] not in ("depth ", "focal ", "own de"):
                    self.assertEqual(camera, CAMERA)

    def test_calibrations_are_off_as_named(self):
        self.assertAlmostEqual(self.played("depth +3 %")[0]["depth_scale"], 1000 / 1.03, places=9)  # what is read is farther
        self.assertAlmostEqual(self.played("depth -3 %")[0]["depth_scale"], 1000 / 0.97, places=9)
        for kind, factor in (("focal length +3 %", 1.03), ("focal length -3 %", 0.97)):
            camera = self.played(kind)[0]
            self.assertAlmostEqual(camera["fx"], factor * FOCAL)
            self.assertAlmostEqual(camera["fy"], factor * FOCAL)
            self.assertEqual(camera["cx"], CAMERA["cx"])

    def test_fewer_frames_and_late_depth(self):
        for kind, depth_of_second in (("every second", 2), ("depth late", 3)):
            camera, shots = self.played(kind)
            self.assertEqual((len(shots), camera["fps"]), (SHOTS // 2, RATE_HZ / 2))
            self.assertAlmostEqual(shots[1].stamp_s, 2 / RATE_HZ, places=5)
            np.testing.assert_array_equal(shots[1].depth, depth_of(depth_of_second))
        camera, shots = self.played("7.5 Hz")  # as near as whole steps come
        self.assertEqual((len(shots), camera["fps"]), (SHOTS, RATE_HZ))

    def test_gamma_and_exposure(self):
        for exponent in (0.4, 2.5):
            expected = 255 * (self.color / 255) ** exponent
            np.testing.assert_allclose(self.played(f"gamma {exponent}")[1][0].color, expected, atol=0.51)
        shots = self.played("exposure jumps")[1]
        for second, factor in ((0, 1.0), (1, 2.0), (2, 1.0), (3, 0.5)):
            expected = 255 * np.minimum(factor * (self.color / 255) ** 2.2, 1.0) ** (1 / 2.2)
            np.testing.assert_allclose(shots[second * RATE_HZ + 1].color, expected, atol=0.51)

    def test_a_turn_up_and_to_the_right_moves_the_image_down_and_to_the_left(self):
        flows = kinds.flows_of(self.sequence)
        np.testing.assert_allclose(flows, [[-FOCAL * TURN_RAD[1], FOCAL * TURN_RAD[0]]] * SHOTS, rtol=2e-3)

    def test_the_flow_is_that_of_a_period_where_an_image_is_missing(self):
        lines = (self.sequence.folder / "associations.txt").read_text().splitlines(keepends=True)
        (self.sequence.folder / "associations.txt").write_text("".join(lines[:10] + lines[12:]))
        flows = kinds.flows_of(read_sequence(self.sequence.folder))
        np.testing.assert_allclose(flows, [[-FOCAL * TURN_RAD[1], FOCAL * TURN_RAD[0]]] * (SHOTS - 2), rtol=2e-2)

    def test_rolling_shutter_shows_each_row_at_an_instant_of_its_own(self):
        shot = self.played("rolling shutter")[1][0]
        for row in (8, HEIGHT // 2, 40):
            when = kinds.READ_OUT_SHARE * (row / HEIGHT - 0.5)
            left, down = round(when * FOCAL * TURN_RAD[1]), round(when * FOCAL * TURN_RAD[0])
            np.testing.assert_array_equal(shot.color[row, 10:50], self.color[row - down, 10 + left:50 + left])

    def test_motion_blur_keeps_the_light_and_takes_the_edges(self):
        shot = self.played("motion blur")[1][0]
        self.assertAlmostEqual(((shot.color / 255) ** 2.2).mean(), ((self.color / 255) ** 2.2).mean(), delta=0.01)
        steps = [np.diff(color.astype(float), axis=1).std() for color in (shot.color, self.color)]
        self.assertLess(steps[0], 0.8 * steps[1])

    def test_depth_of_a_camera_of_its_own_is_what_it_measures_of_planes(self):
        camera = CAMERA | {"width": 160, "height": 120, "fx": 160.0, "fy": 160.0, "cx": 79.5, "cy": 59.5}

        def rendered(focal_px, left_m):
            """Of a floor, a wall that is not square to the view, and a box: mm, and what each pixel shows."""
            v, u = np.mgrid[0:120, 0:160]
            x, y = (u - 79.5) / focal_px, (v - 59.5) / focal_px
            with np.errstate(divide="ignore"):
                floor = np.where(y > 0, 1.0 / y, np.inf)
                wall = (4.0 - 0.5 * left_m) / (1.0 + 0.5 * x)
            is_box = (np.abs(1.5 * x + left_m) < 0.3) & (np.abs(1.5 * y) < 0.3)
            each = np.stack((floor, wall, np.where(is_box, 1.5, np.inf)))
            return 1000.0 * each.min(axis=0), each.argmin(axis=0)

        measured = kinds.seen_by_depth_camera(np.round(rendered(160.0, 0.0)[0]).astype(np.uint16), camera)
        truth, what = rendered(1.11 * 160.0, -0.025)
        far = np.pad(what, 2, mode="edge")
        is_inside = np.all([far[2 + i:122 + i, 2 + j:162 + j] == what for i in (-2, 0, 2) for j in (-2, 0, 2)], axis=0)
        is_seen = is_inside & (measured > 0)
        self.assertGreater(is_seen.sum(), 0.99 * is_inside[:, 8:-8].sum())
        self.assertLess(np.abs(measured - truth)[is_seen].max(), 0.003 * truth.max())

    def test_a_depth_camera_of_its_own_is_stated_with_what_it_measures(self):
        camera, shots = self.played("own depth camera")
        own = camera["depth"]
        self.assertEqual((own["width"], own["height"], own["cx"], own["cy"]), (WIDTH, HEIGHT, camera["cx"], camera["cy"]))
        self.assertAlmostEqual(own["fx"], 1.11 * FOCAL)
        silent = self.played("depth not registered", "silent")
        self.assertNotIn("depth", silent[0])
        np.testing.assert_array_equal(shots[0].depth, silent[1][0].depth)
        # What it measures, put back: the middle of the wall is where the colour camera sees it.
        z = shots[0].depth[24, 32] / 1000
        x = (32 - own["cx"]) / own["fx"] * z + own["position"][0]
        self.assertAlmostEqual(1000 * z, depth_of(0)[24, round(31.5 + FOCAL * x / z)], delta=40)

    def test_holes_take_a_tenth_and_pixels_at_edges_fly_between_near_and_far(self):
        shots = self.played("holes")[1]
        lost = np.mean([((shot.depth == 0) & (depth_of(i) > 0)).mean() / (depth_of(i) > 0).mean()
                        for i, shot in enumerate(shots)])
        self.assertTrue(0.06 < lost < 0.16, lost)
        is_flying = np.array([(shot.depth != depth_of(i)) & (shot.depth > 0) for i, shot in enumerate(shots)])
        self.assertTrue(is_flying[:, 9:31, 19:41].any() and is_flying[:, 39:41].any())
        for rows, columns in ((slice(4, 8), slice(0, 64)), (slice(42, 48), slice(0, 64)), (slice(12, 28), slice(22, 38))):
            self.assertFalse(is_flying[:, rows, columns].any(), "no edge is near")
        flying = np.concatenate([shot.depth[which] for shot, which in zip(shots, is_flying)])
        self.assertTrue(((flying >= 1000) & (flying <= 3000 + SHOTS)).all())

    def test_a_person_hides_what_is_behind_alone(self):
        shots = self.played("person")[1]
        at = kinds.PERSON_DISTANCE_M * 1000
        hidden = shots[9].depth == at
        self.assertTrue(0.05 < hidden.mean() < 0.5, hidden.mean())
        self.assertFalse(hidden[40:].any(), "what is nearer than the person is seen")
        self.assertTrue(hidden[:4].any(), "a person is measured where nothing was")
        np.testing.assert_array_equal(shots[9].depth[~hidden], depth_of(9)[~hidden])
        np.testing.assert_array_equal(shots[9].color[~hidden], self.color[~hidden])
        self.assertFalse((shots[9].color[hidden] == self.color[hidden]).all())
        self.assertTrue(all((shot.depth != at).all() for shot in shots[2 * RATE_HZ + 4:4 * RATE_HZ]), "who has left")

    def test_images_that_nobody_could_track_are_found(self):
        shots = [*self.played("none")[1]]
        self.assertEqual(kinds.share_of_poor_shots(shots), 0.0)
        dark = kinds.Shot(0.0, np.zeros_like(self.color), depth_of(0))
        blind = kinds.Shot(0.0, self.color, np.zeros_like(depth_of(0)))
        self.assertAlmostEqual(kinds.share_of_poor_shots([*shots, dark, blind]), 2 / (SHOTS + 2))


class SequencesTest(InAFolder):
    def refusal(self, kind="none", **arguments):
        with self.assertRaises(SequenceError) as refused:
            sequence = read_sequence(make_sequence(self.folder / "odd", **arguments))
            camera, shots = kinds.KINDS[kind](sequence, np.random.default_rng(1))
            write_sequence(self.folder / "changed", sequence, camera, shots)
        return str(refused.exception)

    def test_calibrations_and_lists_that_are_none(self):
        without = {key: value for key, value in CAMERA.items() if key != "fy"}
        self.assertIn("camera.yaml: fy: wanted is a number above 0", self.refusal(camera=without))

    def test_distortion(self):
        self.assertIn("wanted are rectified images", self.refusal(camera=CAMERA | {"distortion": [0.1, 0, 0, 0, 0]}))

    def test_few_images(self):
        self.assertIn("has 3 images", self.refusal(shots=3))

    def test_blur_without_ground_truth(self):
        self.assertIn("groundtruth.txt: wanted are poses", self.refusal(kind="motion blur", with_truth=False))

    def test_images_of_another_size(self):
        self.assertIn("rgb/0.png: has (64, 48) pixels", self.refusal(camera=CAMERA | {"width": 32}))

    def test_depth_of_eight_bits(self):
        sequence = read_sequence(make_sequence(self.folder / "plain"))
        Image.fromarray(depth_of(0).astype(np.uint8)).save(sequence.folder / "depth/4.png")
        with self.assertRaisesRegex(SequenceError, "depth/4.png: wanted is one channel of 16 bits"):
            list(sequence.shots())


# In place of replay.sh: notes what was asked for, and leaves metrics.
REPLAY = """#!/usr/bin/env python3
import json, pathlib, sys
folder = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
with (pathlib.Path(__file__).parent.parent / "played").open("a") as played:
    played.write(" ".join([folder.parent.name, folder.name, *sys.argv[4:]]) + "\\n")
status = {"holes": 1, "JPEG_60": 143}.get(folder.name, 0)
if status == 0:
    folder.mkdir(exist_ok=True)
    ate_m = {"gamma_0.4": None, "depth_+3__": 0.05}.get(folder.name, 0.02)
    total = 0 if folder.name == "person" else 32
    tracked = 24 if folder.name == "gamma_0.4" else 32
    (folder / "metrics.json").write_text(json.dumps({"frames_total": total, "frames_tracked": tracked, "ate_se3_rmse_m": ate_m,
                                                     "cpu_ms_per_frame": {"slam": 5.0}}))
    if folder.name == "depth_+3__":
        (folder / "logs").mkdir()
        (folder / "logs/slam.log").write_text("1 warning slam: focal length seems to be 5.1 px (+- 0.1), /camera/x says 5\\n"
            "2 warning slam: depth seems to be of a camera with fx 7.0, 1 cm to the left (edges lie 3 px off): correct\\n")
sys.exit(status)
"""
# In place of the benchmark.
BENCHMARK = """#!/bin/sh
case $2 in *gamma*) exit 1;; esac
echo "slam, tracking frame                          219      6.28     12.85    0.14"
echo "ATE (SE(3)): slam 0.37 cm over 268 of 268 frames, OpenCV 29.06 cm"
"""


class CommandTest(PretendedPrograms):
    def setUp(self):
        super().setUp()
        for file in ("CMakeLists.txt", "CMakePresets.json"):
            (self.folder / file).write_text("of all\n")
        self.script("launch_scripts/replay.sh", REPLAY)
        self.script("bin/lapis_tracking_benchmark", BENCHMARK)
        self.sequence = make_sequence(self.folder / "walk")
        self.rows = self.folder / "rows.csv"

    def run_it(self, *arguments, status=0):
        result = subprocess.run([self.folder / "launch_scripts/perturb.sh", *arguments, "--results", self.rows, "--out",
                                 self.folder / "out"], env=self.environment(), capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def played(self):
        file = self.folder / "played"
        return file.read_text().splitlines() if file.exists() else []

    def test_rows_are_kept_and_failures_are_said(self):
        result = self.run_it(self.sequence, "--kinds", "none, holes, gamma 0.4, depth +3 %, person", status=1)
        self.assertIn("walk, holes: replay.sh failed with status 1, log", result.stderr)
        self.assertIn("walk, person: ", result.stderr)
        for row in ("| walk | none | 32 | 100.0 % | 2.00 cm | 1.00 | 29.06 cm | 5.0 ms | 1.00 | 0.14 | - |  |",
                    "| walk | depth +3 % | 32 | 100.0 % | 5.00 cm | 2.50 | 29.06 cm | 5.0 ms | 1.00 | 0.14 | ATE > 2 x | focal length "
                    "seems to be 5.1 px (+- 0.1); depth seems to be of a camera with fx 7.0, 1 cm to the left |",
                    "| walk | gamma 0.4 | 32 | 75.0 % | - | - | - | 5.0 ms | 1.00 | - | tracked < 95 % |  |"):
            self.assertIn(row, result.stdout)
        self.assertNotIn("| walk | holes", result.stdout)
        self.assertEqual(len(self.played()), 5)

    def test_a_camera_that_is_lost_too_often_is_a_failure(self):
        self.assertIn("| tracked < 95 % |", self.run_it(self.sequence, "--kinds", "none, gamma 0.4", status=1).stdout)
        self.run_it(self.sequence, "--kinds", "none, depth +3 %")

    def test_what_has_a_row_is_not_repeated_unless_something_that_it_depends_on_has_changed(self):
        kind = ("--kinds", "none")
        row = "| walk | none | 32 |"
        self.run_it(self.sequence, *kind)
        self.assertIn(row, self.run_it(self.sequence, *kind).stdout)
        self.assertEqual(len(self.played()), 1)
        self.assertNotIn(row, self.run_it(self.sequence, *kind, "--table", "--set", "slam.a=1").stdout)
        self.assertIn(row, self.run_it(self.sequence, *kind, "--set", "slam.a=1").stdout)
        self.assertEqual(self.played()[1], "walk none --set slam.a=1")
        with (self.sequence / "camera.yaml").open("a") as camera:
            camera.write("camera_height: 1.0\n")
        self.assertIn(row, self.run_it(self.sequence, *kind).stdout)
        with (self.folder / "launch_scripts/perturbations/kinds.py").open("a") as code:
            code.write("# another one\n")
        self.assertIn(row, self.run_it(self.sequence, *kind).stdout)
        self.assertEqual(len(self.played()), 4)

    def test_places_that_cannot_be_written_are_named_before_anything_is_played(self):
        (self.folder / "out").write_text("a file")
        self.assertIn("--out: ", self.run_it(self.sequence, status=2).stderr)
        (self.folder / "out").unlink()
        self.rows = self.folder / "launch_scripts/replay.sh/rows.csv"
        self.assertIn("--results: ", self.run_it(self.sequence, status=2).stderr)
        self.assertEqual(self.played(), [])

    def test_an_interruption_ends_it(self):
        self.run_it(self.sequence, "--kinds", "JPEG 60, none", status=143)
        self.assertEqual(len(self.played()), 1)
        self.assertFalse(self.rows.exists())

    def test_sources_that_no_program_knows(self):
        (self.folder / "components/new.cpp").write_text("// newer than the programs\n")
        self.assertIn("is newer than the programs", self.run_it(self.sequence, status=2).stderr)

    def test_wrong_words_are_refused(self):
        other = make_sequence(self.folder / "other/walk")
        for arguments, words in (((self.sequence, "--kinds", "fog"), "--kinds: no such kind: fog"),
                                 ((self.sequence, other), "two sequences are called walk"),
                                 ((self.folder / "nowhere",), "wanted is a sequence with camera.yaml and associations.txt")):
            self.assertIn(words, self.run_it(*arguments, status=2).stderr)
        self.assertEqual(self.played(), [])


if __name__ == "__main__":
    unittest.main()
