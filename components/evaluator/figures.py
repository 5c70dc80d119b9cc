#!/usr/bin/python3
"""Draws figures/*.png of a run folder: trajectory over the map, errors over time, IoU per class.

A figure whose input files are missing is left out, with a line saying which file; exit status 0 when at least one
figure was drawn, 1 when none was, 2 when the folder does not exist.
"""
import argparse
import json
import os
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import numpy as np  # noqa: E402

ESTIMATE = "trajectory_estimate.txt"
TRUTH = "trajectory_ground_truth.txt"
BLUE, ORANGE, GREY = "#1565c0", "#e65100", "#9e9e9e"
HEAD_ROOM_M = 0.5  # what lies higher above the camera (ceilings) would hide the rooms
MAX_GAP_S = 0.02  # as the evaluator: the nearest true pose must be closer than this
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2",
             "uint": "<u4", "int": "<i4"}


class MissingInput(Exception):
    """A file that a figure needs is absent or holds nothing to draw; the message names it."""


def read_trajectory(path):
    """TUM file to (stamps [n], positions [n, 3], quaternions xyzw [n, 4])."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    rows = [line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    if not rows:
        raise MissingInput(f"{path.name} holds no pose")
    try:
        table = np.array(rows, dtype=float).reshape(len(rows), 8)
    except ValueError as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error
    return table[:, 0], table[:, 1:4], table[:, 4:8]


def read_map(path):
    """PLY points to (positions [n, 3], colours [n, 3] in 0..1), or None without a usable file."""
    if not path.is_file():
        return None
    data = path.read_bytes()
    head, separator, body = data.partition(b"end_header\n")
    lines = head.decode("ascii", "replace").splitlines()
    if not separator or "format binary_little_endian 1.0" not in lines:
        return None
    try:
        count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
        fields = [(line.split()[2], PLY_TYPES[line.split()[1]]) for line in lines if line.startswith("property")]
        vertices = np.frombuffer(body, dtype=np.dtype(fields), count=count)
        positions = np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float)
        colours = np.stack([vertices[name] for name in ("red", "green", "blue")], axis=1) / 255.0
    except (StopIteration, KeyError, IndexError, ValueError):
        return None
    return (positions, colours) if count else None


def interpolate(stamps, positions, quaternions, at):
    """True poses at the stamps `at` (linear, slerp), and a mask of those that exist."""
    after = np.clip(np.searchsorted(stamps, at), 0, len(stamps) - 1)
    before = np.where(stamps[after] == at, after, np.maximum(after - 1, 0))
    gap = np.minimum(np.abs(stamps[after] - at), np.abs(at - stamps[before]))
    valid = (gap < MAX_GAP_S) & (at >= stamps[0]) & (at <= stamps[-1])
    span = np.where(stamps[after] > stamps[before], stamps[after] - stamps[before], 1.0)
    share = ((at - stamps[before]) / span)[:, None]
    p = (1 - share) * positions[before] + share * positions[after]
    a, b = quaternions[before], quaternions[after]
    dot = np.sum(a * b, axis=1, keepdims=True)
    b = np.where(dot < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(dot), 0, 1))
    sine = np.where(angle > 1e-6, np.sin(angle), 1.0)
    weights = np.where(angle > 1e-6, np.sin((1 - share) * angle) / sine, 1 - share), \
        np.where(angle > 1e-6, np.sin(share * angle) / sine, share)
    return p, weights[0] * a + weights[1] * b, valid


def heading_error(estimate, truth):
    """Turn about z [rad] in R_estimate * R_truth', from quaternions xyzw."""
    ax, ay, az, aw = estimate.T
    bx, by, bz, bw = -truth[:, 0], -truth[:, 1], -truth[:, 2], truth[:, 3]
    w = aw * bw - ax * bx - ay * by - az * bz
    z = aw * bz + ax * by - ay * bx + az * bw
    return (2 * np.arctan2(z, w) + np.pi) % (2 * np.pi) - np.pi


def break_gaps(stamps, values):
    """The values with NaN rows put in where time jumps, so that lines do not bridge lost stretches."""
    steps = np.diff(stamps)
    gaps = np.flatnonzero(steps > max(0.5, 5 * np.median(steps))) + 1 if len(steps) else []
    return np.insert(stamps.astype(float), gaps, np.nan), np.insert(values.astype(float), gaps, np.nan, axis=0)


def draw_map(axes, points, ceiling):
    """The map from above: each cell shows its highest voxel below the ceiling."""
    positions, colours = points
    keep = positions[:, 2] < ceiling
    if not keep.any():
        return
    positions, colours = positions[keep], colours[keep]
    steps = np.diff(np.unique(np.round(positions[:, 0], 4)))
    edge = steps.min() if len(steps) else 0.25
    order = np.argsort(positions[:, 2], kind="stable")
    low = positions[:, :2].min(axis=0)
    cells = np.round((positions[order, :2] - low) / edge).astype(int)
    image = np.ones((cells[:, 1].max() + 1, cells[:, 0].max() + 1, 4))
    image[..., 3] = 0.0
    image[cells[:, 1], cells[:, 0], :3] = 0.45 + 0.55 * colours[order]  # pale: the lines are what matters
    image[cells[:, 1], cells[:, 0], 3] = 1.0
    high = low + edge * np.array([image.shape[1] - 1, image.shape[0] - 1])
    axes.imshow(image, origin="lower", interpolation="nearest",
                extent=(low[0] - edge / 2, high[0] + edge / 2, low[1] - edge / 2, high[1] + edge / 2))


def draw_trajectory(run):
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    figure, axes = plt.subplots(figsize=(10, 7.5))
    points = read_map(run / "map.ply")
    if points is None:
        print(f"figures: {run / 'map.ply'} is missing or unreadable; trajectory.png is drawn without the map",
              file=sys.stderr)
    else:
        draw_map(axes, points, positions[:, 2].mean() + HEAD_ROOM_M)
    try:
        truth_stamps, truth, _ = read_trajectory(run / TRUTH)
        axes.plot(*break_gaps(truth_stamps, truth)[1][:, :2].T, color="black", linewidth=2.6, label="ground truth")
    except MissingInput as missing:
        print(f"figures: {missing}; trajectory.png is drawn without ground truth", file=sys.stderr)
    axes.plot(*break_gaps(stamps, positions)[1][:, :2].T, color=ORANGE, linewidth=1.4, label="estimate")
    axes.plot(*positions[0, :2], "o", color="white", markeredgecolor="black", markersize=9, label="start")
    axes.plot(*positions[-1, :2], "s", color=ORANGE, markeredgecolor="black", markersize=9, label="end")
    axes.set_aspect("equal", adjustable="datalim" if points is None else "box")
    axes.margins(0.08)
    axes.set(xlabel="x [m]", ylabel="y [m]", title=f"Trajectory in the map frame: {run.resolve().name}")
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    return figure


def draw_errors(run):
    stamps, positions, quaternions = read_trajectory(run / ESTIMATE)
    truth = read_trajectory(run / TRUTH)
    true_positions, true_quaternions, valid = interpolate(*truth, stamps)
    if not valid.any():
        raise MissingInput(f"no stamp of {ESTIMATE} is near one of {TRUTH}")
    seconds = stamps[valid] - stamps[0]
    position_cm = 100 * np.linalg.norm((positions - true_positions)[valid], axis=1)
    heading_deg = np.degrees(heading_error(quaternions[valid], true_quaternions[valid]))
    figure, panels = plt.subplots(2, 1, figsize=(10, 6), sharex=True)
    for axes, values, name, colour in ((panels[0], position_cm, "position error [cm]", BLUE),
                                       (panels[1], heading_deg, "heading error [deg]", ORANGE)):
        axes.plot(*break_gaps(seconds, values), color=colour, linewidth=1.5)
        rmse = float(np.sqrt(np.mean(values**2)))
        axes.axhline(rmse, color=GREY, linewidth=1, linestyle="--", label=f"RMSE {rmse:.2f}")
        axes.set_ylabel(name)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.legend(loc="upper left", framealpha=0.9)
    panels[0].set_ylim(bottom=0)
    panels[0].set_title("Errors of the pose as published at its time, both in the map frame, not aligned")
    panels[1].set_xlabel("time since the first pose [s]")
    return figure


def draw_class_iou(run):
    path = run / "metrics.json"
    if not path.is_file():
        raise MissingInput("metrics.json is missing")
    try:
        metrics = json.loads(path.read_text())
    except ValueError as error:
        raise MissingInput(f"metrics.json is damaged ({error})") from error
    classes = metrics.get("iou_by_class")
    if not classes:
        raise MissingInput("metrics.json has no iou_by_class (not measured)")
    names = list(classes)
    values = [classes[name]["iou"] for name in names]
    is_top = [classes[name]["top8"] for name in names]
    figure, axes = plt.subplots(figsize=(9, 1.4 + 0.36 * len(names)))
    rows = np.arange(len(names))
    axes.barh(rows, values, color=[BLUE if top else GREY for top in is_top], height=0.7)
    for row, name in enumerate(names):
        axes.text(values[row] + 0.01, row, f"{values[row]:.2f}  ({classes[name]['reference_voxels']} voxels)",
                  va="center", fontsize=9, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0})
    mean = metrics.get("iou_top8_mean")
    if mean is not None:
        axes.axvline(mean, color=ORANGE, linewidth=1.4, linestyle="--")
        axes.set_title(f"IoU by class; mean of the 8 most frequent (blue, dashed line): {mean:.3f}")
    axes.set_yticks(rows, names)
    axes.invert_yaxis()
    axes.set_xlim(0, 1.18)
    axes.set_xticks(np.arange(0, 1.01, 0.2))
    axes.set_xlabel("intersection over union")
    axes.grid(axis="x", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure


FIGURES = {"trajectory.png": draw_trajectory, "errors.png": draw_errors, "class_iou.png": draw_class_iou}


def save(figure, path):
    """Written beside and renamed; without date or version, so that equal runs give equal pictures."""
    part = path.with_name(path.name + ".part")
    figure.savefig(part, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)
    os.replace(part, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="run folder")
    run = parser.parse_args().run
    if not run.is_dir():
        print(f"figures: {run} is not a folder; give the run folder that the evaluator wrote", file=sys.stderr)
        return 2
    folder = run / "figures"
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        print(f"figures: cannot create {folder}: {error.strerror}", file=sys.stderr)
        return 2
    drawn = 0
    for name, draw in FIGURES.items():
        try:
            save(draw(run), folder / name)
            drawn += 1
        except MissingInput as missing:
            print(f"figures: {name} left out: {missing}", file=sys.stderr)
    return 0 if drawn else 1


if __name__ == "__main__":
    sys.exit(main())
