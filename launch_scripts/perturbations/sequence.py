"""Recorded sequences in the layout of the TUM RGB-D benchmark: read, and written with other images."""

import contextlib
import dataclasses
import hashlib
import os
import pathlib
import shutil

import numpy as np
import yaml
from PIL import Image

NUMBERS = ("width", "height", "fx", "fy", "cx", "cy", "depth_scale", "fps")  # of camera.yaml
FEWEST = 10  # images of a sequence
FARTHEST_S = 0.02  # between the stamps of an image and of its true pose


class SequenceError(Exception):
    """One line that names the file and the remedy."""


@dataclasses.dataclass(frozen=True)
class Shot:
    """What the camera gives at an instant: its colours [h, w, 3 bytes], or the bytes of a JPEG file of them, and depth [h, w,
    uint16 in units of 1 / depth_scale, 0 where nothing was measured]."""
    stamp_s: float
    color: np.ndarray
    depth: np.ndarray


@dataclasses.dataclass(frozen=True)
class Sequence:
    """A folder, its camera.yaml, and (stamp, colour file, depth file) of each shot."""
    folder: pathlib.Path
    camera: dict
    files: list

    @property
    def name(self):
        return self.folder.resolve().name

    @property
    def rate_hz(self):
        stamps = [stamp for stamp, _, _ in self.files]
        return 1.0 / float(np.median(np.diff(stamps)))

    def shots(self):
        """Throws SequenceError that names an image that is not what it should be."""
        for stamp, color, depth in self.files:
            yield Shot(stamp, self.image(color, "RGB"), self.image(depth, "I"))

    def image(self, file, mode):
        try:
            with Image.open(self.folder / file) as image:
                wanted = (self.camera["width"], self.camera["height"])
                if image.size != wanted:
                    raise SequenceError(f"{self.folder / file}: has {image.size} pixels, and camera.yaml says {wanted}")
                if mode == "RGB":
                    return np.asarray(image.convert("RGB"))
                if not image.mode.startswith("I"):
                    raise SequenceError(f"{self.folder / file}: wanted is one channel of 16 bits")
                return np.asarray(image).astype(np.uint16)
        except OSError as error:
            raise SequenceError(f"{self.folder / file}: {error}") from error

    def hash(self):
        """Of its lists, poses and calibration, not of its images."""
        digest = hashlib.sha256()
        for name in ("camera.yaml", "associations.txt", "groundtruth.txt"):
            with contextlib.suppress(FileNotFoundError):
                digest.update((self.folder / name).read_bytes())
        return digest.hexdigest()


def read_sequence(folder, fewest=FEWEST):
    """Of a folder with camera.yaml and associations.txt, of a camera without distortion."""
    folder = pathlib.Path(folder)
    try:
        camera = yaml.safe_load((folder / "camera.yaml").read_text(encoding="utf-8"))
        lines = (folder / "associations.txt").read_text(encoding="utf-8").splitlines()
        rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
        files = [(float(stamp), color, depth) for stamp, color, _, depth in rows]
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise SequenceError(f"{folder}: wanted is a sequence with camera.yaml and associations.txt ({error})") from error
    given = camera if isinstance(camera, dict) else {}
    for key in NUMBERS:
        if not (isinstance(given.get(key), (int, float)) and given[key] > 0):
            raise SequenceError(f"{folder}/camera.yaml: {key}: wanted is a number above 0")
    if any(given.get("distortion") or ()):
        raise SequenceError(f"{folder}/camera.yaml: distortion: wanted are rectified images")
    if len(files) < fewest:
        raise SequenceError(f"{folder}/associations.txt: has {len(files)} images; wanted are at least {fewest}")
    return Sequence(folder, camera, files)


def turn_rates_of(sequence):
    """How fast the camera turns at each shot, in its own frame [n, 3, in rad/s], by groundtruth.txt; the last one is that
    before."""
    file = sequence.folder / "groundtruth.txt"
    try:
        rows = np.loadtxt(file, comments="#", ndmin=2)
        stamps, quaternions = rows[:, 0], rows[:, 4:8]
    except (OSError, ValueError, IndexError) as error:
        raise SequenceError(f"{file}: wanted are poses, for blur and rolling shutters come of turns ({error})") from error
    nearest = [int(np.argmin(np.abs(stamps - stamp))) for stamp, _, _ in sequence.files]
    for at, (stamp, _, _) in zip(nearest, sequence.files):
        if abs(stamps[at] - stamp) > FARTHEST_S:
            raise SequenceError(f"{file}: has no pose within {FARTHEST_S} s of the image of {stamp:.6f} s")
    turned = [turn_between(quaternions[a], quaternions[b]) for a, b in zip(nearest[:-1], nearest[1:])]
    elapsed_s = np.diff([stamp for stamp, _, _ in sequence.files])
    rates = np.array(turned) / elapsed_s[:, None]
    return np.vstack((rates, rates[-1:]))


def turn_between(a, b):
    """The rotation vector of conj(a) b, both unit quaternions (x, y, z, w) [rad]; exact for small turns."""
    vector = a[3] * b[:3] - b[3] * a[:3] - np.cross(a[:3], b[:3])
    return 2.0 * vector * np.sign(a @ b)


def write_sequence(target, sequence, camera, shots):
    """A sequence with this camera.yaml and these shots, in place of whatever `target` held. Returns how many they are."""
    part = target.with_name(target.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    for name in ("rgb", "depth"):
        (part / name).mkdir(parents=True)
    lines = []
    for shot in shots:
        color, depth = (f"{name}/{len(lines):05d}" for name in ("rgb", "depth"))
        if isinstance(shot.color, bytes):
            (part / f"{color}.jpg").write_bytes(shot.color)
        else:
            Image.fromarray(shot.color).save(part / f"{color}.png", compress_level=1)
        Image.fromarray(shot.depth).save(part / f"{depth}.png", compress_level=1)
        suffix = "jpg" if isinstance(shot.color, bytes) else "png"
        lines.append(f"{shot.stamp_s:.6f} {color}.{suffix} {shot.stamp_s:.6f} {depth}.png\n")
    (part / "associations.txt").write_text("".join(lines), encoding="utf-8")
    (part / "camera.yaml").write_text(yaml.safe_dump(camera), encoding="utf-8")
    with contextlib.suppress(FileNotFoundError):
        shutil.copyfile(sequence.folder / "groundtruth.txt", part / "groundtruth.txt")
    shutil.rmtree(target, ignore_errors=True)
    os.replace(part, target)
    return len(lines)
