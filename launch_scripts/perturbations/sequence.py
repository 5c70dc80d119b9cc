"""Recorded sequences in the layout of the TUM RGB-D benchmark: read, and written with other images."""

import contextlib
import dataclasses
import os
import pathlib
import shutil

import numpy as np
import yaml
from PIL import Image


class SequenceError(Exception):
    """One line that names the file and the remedy."""


@dataclasses.dataclass(frozen=True)
class Shot:
    """What the camera gives at an instant: its colours [h, w, 3 bytes] and depth [h, w, uint16 in units of 1 / depth_scale,
    0 where nothing was measured]."""
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
    def rate_hz(self):
        stamps = [stamp for stamp, _, _ in self.files]
        return 1.0 / float(np.median(np.diff(stamps)))

    def shots(self):
        for stamp, color, depth in self.files:
            yield Shot(stamp, image_of(self.folder / color, np.uint8), image_of(self.folder / depth, np.uint16))


def image_of(file, kind):
    try:
        with Image.open(file) as image:
            return np.asarray(image.convert("RGB") if kind == np.uint8 else image).astype(kind)
    except OSError as error:
        raise SequenceError(f"{file}: {error}") from error


def read_sequence(folder):
    """Of a folder with camera.yaml and associations.txt."""
    folder = pathlib.Path(folder)
    try:
        camera = yaml.safe_load((folder / "camera.yaml").read_text(encoding="utf-8"))
        lines = (folder / "associations.txt").read_text(encoding="utf-8").splitlines()
        rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
        files = [(float(stamp), color, depth) for stamp, color, _, depth in rows]
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise SequenceError(f"{folder}: wanted is a sequence with camera.yaml and associations.txt ({error})") from error
    if len(files) < 2:
        raise SequenceError(f"{folder}/associations.txt: fewer than two images")
    return Sequence(folder, camera, files)


def turns_of(sequence):
    """How far the camera turns up to the next shot, in its own frame [n, 3, in rad], by groundtruth.txt; zero without it."""
    turns = np.zeros((len(sequence.files), 3))
    with contextlib.suppress(OSError):
        rows = np.loadtxt(sequence.folder / "groundtruth.txt", comments="#", ndmin=2)
        nearest = [int(np.argmin(np.abs(rows[:, 0] - stamp))) for stamp, _, _ in sequence.files]
        quaternions = rows[nearest, 4:8]
        turns[:-1] = [turn_between(a, b) for a, b in zip(quaternions[:-1], quaternions[1:])]
    return turns


def turn_between(a, b):
    """The rotation vector of conj(a) b, both unit quaternions (x, y, z, w) [rad]; exact for small turns."""
    vector = a[3] * b[:3] - b[3] * a[:3] - np.cross(a[:3], b[:3])
    return 2.0 * vector * np.sign(a @ b)


def write_sequence(target, sequence, camera, shots):
    """A sequence with this camera.yaml and these shots, in place of whatever `target` held; colours as JPEG only if they are
    bytes of such a file. Returns how many shots there are."""
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
