#!/usr/bin/python3
"""Draws figures/*.png of a run folder: map, trajectory, pose graph, coverage, errors, progress, IoU by class, a decision.

A figure whose input files are missing is left out, with a line saying which file; exit status 0 when at least one
figure was drawn, 1 when none was, 2 when the folder does not exist.
"""
import argparse
import collections
import csv
import itertools
import json
import math
import os
import sys
import textwrap
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import matplotlib.ticker  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402

ESTIMATE = "trajectory_estimate.txt"
TRUTH = "trajectory_ground_truth.txt"
DECISIONS, DECISION_PLAN = "decisions.csv", "decision.json"
BLUE, ORANGE, GREY = "#1565c0", "#e65100", "#9e9e9e"
OTHER_METHODS = (("s", BLUE), ("D", "#6a1b9a"), ("^", "#2e7d32"), ("v", "#c62828"), ("p", "#00838f"))
TIERS = {"vision": "#66bb6a", "surfaces": "#42a5f5", "odometry": "#ffb300", "none": "#d32f2f"}  # frames.csv
PLANNER_STATES = {"EXPLORING": "#aed581", "RECOVERING": "#ffb300", "RETURNING": "#90caf9", "PAUSED": "#ce93d8", "IDLE": "#eeeeee",
                  "CONSOLIDATING": "#4db6ac", "DONE": "#2e7d32", "GAVE_UP": "#e65100", "FAILED": "#d32f2f"}
LEAST_SHOWN_M = 1e-3  # on a logarithmic axis
HEAD_ROOM_M = 0.5  # what lies higher above the camera (ceilings) would hide the rooms
DECISION_BARS = (("utility", "utility"), ("path_information_nats", "information\nof the path\n[nat]"),
                 ("cost_m", "cost [m]"), ("d_optimality", "D-optimality"))
CHOSEN_BY = "is_chosen_by_"  # and a method: a column of decisions.csv
MAX_CLASSES = 14  # in the legend of the map
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


def read_table(path):
    """CSV file to a list of rows, each a dictionary of texts."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def numbers(rows, column, path):
    """A column of read_table [n]; NaN where a cell is empty."""
    try:
        return np.array([float(row[column]) if row[column] else np.nan for row in rows])
    except (KeyError, TypeError, ValueError) as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error


def read_map(path):
    """PLY points to (positions [n, 3], colours [n, 3] in 0..1, labels [n]), or None without a usable file."""
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
        labels = vertices["label"].astype(int)
    except (StopIteration, KeyError, IndexError, ValueError):
        return None
    return (positions, colours, labels) if count else None


def read_pose_graph(path):
    """g2o file to (positions [n, 3], edges [m, 2] as indices of positions)."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    rows = [line.split() for line in path.read_text().splitlines()]
    try:
        vertices = [row for row in rows if row and row[0] == "VERTEX_SE3:QUAT"]
        index = {int(row[1]): i for i, row in enumerate(vertices)}
        positions = np.array([row[2:5] for row in vertices], dtype=float).reshape(len(vertices), 3)
        edges = [(index[int(row[1])], index[int(row[2])]) for row in rows if row and row[0] == "EDGE_SE3:QUAT"]
    except (IndexError, KeyError, ValueError) as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error
    if not vertices:
        raise MissingInput(f"{path.name} holds no pose")
    return positions, np.array(edges, dtype=int).reshape(len(edges), 2)


def class_names(run):
    """Names by class id, from what the simulator or a recording says of them; empty when nothing does."""
    try:
        classes = json.loads((run / "ground_truth/classes.json").read_text())["classes"]
        return {int(c["id"]): str(c["name"]) for c in classes}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


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


def draw_map(axes, points, ceiling, paleness=0.45):
    """The map from above: each cell shows its highest voxel below the ceiling. Returns, for each class that is seen, its
    number of cells and its colour."""
    positions, colours, labels = points
    keep = positions[:, 2] < ceiling
    if not keep.any():
        return {}
    positions, colours, labels = positions[keep], colours[keep], labels[keep]
    steps = np.diff(np.unique(np.round(positions[:, 0], 4)))
    edge = steps.min() if len(steps) else 0.25
    order = np.argsort(positions[:, 2], kind="stable")
    low = positions[:, :2].min(axis=0)
    cells = np.round((positions[order, :2] - low) / edge).astype(int)
    image = np.ones((cells[:, 1].max() + 1, cells[:, 0].max() + 1, 4))
    image[..., 3] = 0.0
    image[cells[:, 1], cells[:, 0], :3] = paleness + (1 - paleness) * colours[order]
    image[cells[:, 1], cells[:, 0], 3] = 1.0
    top = {(x, y): i for i, (x, y) in zip(order, cells)}  # the highest one comes last
    high = low + edge * np.array([image.shape[1] - 1, image.shape[0] - 1])
    axes.imshow(image, origin="lower", interpolation="nearest",
                extent=(low[0] - edge / 2, high[0] + edge / 2, low[1] - edge / 2, high[1] + edge / 2))
    cells_of = collections.Counter(int(labels[i]) for i in top.values())
    colour_of = {int(labels[i]): colours[i] for i in top.values()}
    return {label: (count, colour_of[label]) for label, count in sorted(cells_of.items())}


def finish_plan(axes, title, has_map=True):
    """What all figures seen from above have in common."""
    axes.use_sticky_edges = False
    axes.set_aspect("equal", adjustable="box" if has_map else "datalim")
    axes.margins(0.04)
    axes.set(xlabel="x [m]", ylabel="y [m]", title=title)
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)


def draw_classes(run):
    """The map from above in the colours of its classes, with the path of the robot."""
    points = read_map(run / "map.ply")
    if points is None:
        raise MissingInput("map.ply is missing or unreadable")
    _, positions, _ = read_trajectory(run / ESTIMATE)
    figure, axes = plt.subplots(figsize=(10, 7.5))
    seen = draw_map(axes, points, positions[:, 2].mean() + HEAD_ROOM_M, paleness=0.0)
    axes.plot(*positions[:, :2].T, color="white", linewidth=2.4)
    driven, = axes.plot(*positions[:, :2].T, color="black", linewidth=1.2)
    start, = axes.plot(*positions[0, :2], "o", color="white", markeredgecolor="black", markersize=8)
    end, = axes.plot(*positions[-1, :2], "s", color="white", markeredgecolor="black", markersize=8)
    names = class_names(run)
    named = sorted(((count, names[label], colour) for label, (count, colour) in seen.items() if label in names),
                   key=lambda entry: (-entry[0], entry[1]))[:MAX_CLASSES]
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor="#555555", linewidth=0.5)
               for _, _, colour in named]
    axes.legend([driven, start, end, *patches], ["path of the robot", "start", "end", *(name for _, name, _ in named)],
                loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    finish_plan(axes, f"Semantic map from above, without ceilings: {run.resolve().name}")
    return figure


def draw_coverage(run):
    path = run / "timeline.csv"
    rows = read_table(path)
    seconds, volume, share = (numbers(rows, column, path) for column in
                              ("time_s", "explored_volume_m3", "explored_share"))
    if not np.isfinite(volume).any():
        raise MissingInput("timeline.csv has no explored volume")
    figure, axes = plt.subplots(figsize=(10, 5))
    axes.plot(seconds, volume, color=BLUE, linewidth=1.8)
    axes.set(xlabel="time since the first frame [s]", ylabel="explored volume [m³]", title="Explored volume over time")
    axes.set_xlim(0, seconds[-1])
    axes.set_ylim(bottom=0)
    axes.grid(color="#dddddd", linewidth=0.6)
    if not np.isfinite(share).any():
        return figure
    axes.yaxis.label.set_color(BLUE)
    right = axes.twinx()
    right.plot(seconds, 100 * share, color=ORANGE, linewidth=1.8)
    right.set_ylabel("share of the explorable volume [%]", color=ORANGE)
    right.set_ylim(0, 100)
    for level in (80, 90):
        reached = np.flatnonzero(100 * share >= level)
        if len(reached):
            first = seconds[reached[0]], 100 * share[reached[0]]
            right.plot(*first, "o", color=ORANGE)
            right.annotate(f"{level} % after {first[0]:.0f} s", first, xytext=(8, -14), textcoords="offset points",
                           color=ORANGE)
    return figure


def metric(run, key):
    """A figure of metrics.json; None where that does not say."""
    try:
        return json.loads((run / "metrics.json").read_text())[key]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def draw_pose_graph(run):
    """Edges between key-frames that follow each other, and others. The file has no types of edges: others are loop
    closures, and odometry of key-frames that were tracked from an older one than the last."""
    positions, edges = read_pose_graph(run / "pose_graph.g2o")
    is_other = np.abs(edges[:, 1] - edges[:, 0]) > 1
    figure, axes = plt.subplots(figsize=(10, 7.5))
    for kind, colour in ((~is_other, BLUE), (is_other, ORANGE)):
        axes.add_collection(LineCollection(positions[edges[kind], :2], colors=colour, linewidths=1.0))
    nodes, = axes.plot(*positions[:, :2].T, ".", color=BLUE, markersize=4)
    following, others = (plt.Line2D([], [], color=colour) for colour in (BLUE, ORANGE))
    loops = metric(run, "loop_closures")
    axes.legend([nodes, following, others],
                [f"{len(positions)} key-frames", f"{(~is_other).sum()} edges between neighbours in time",
                 f"{is_other.sum()} other edges" + ("" if loops is None else f"\n(loop closures: {loops})")],
                loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    finish_plan(axes, f"Pose graph, optimised: {run.resolve().name}", has_map=False)
    return figure


def read_decision_plan(run):
    """What the planner knew at the decision with most candidates; None where it left no such file, as it did before."""
    path = run / DECISION_PLAN
    try:
        return json.loads(path.read_text()) if path.is_file() else None
    except ValueError as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error


def shown_decision(rows, number):
    """Rows of a decision, those that were not rejected first and the best of them foremost, and their number."""
    of = [row for row in rows if int(row["decision"]) == number]
    of.sort(key=lambda row: (bool(row["rejection"]), -float(row["utility"])))
    return of, sum(not row["rejection"] for row in of)


def with_most_candidates(rows):
    """Number of the first decision with most candidates that were not rejected."""
    accepted = collections.Counter(int(row["decision"]) for row in rows if not row["rejection"])
    return accepted.most_common(1)[0][0] if accepted else int(rows[0]["decision"])


def draw_floor_plan(axes, plan):
    """Free, occupied and unknown cells, and frontiers, as they were then; returns what the legend says of them."""
    rows = plan["plan"]["rows"]
    if not rows:
        return []
    shades = {" ": 0.85, ".": 1.0, "#": 0.35}
    x, y = plan["plan"]["lower_left_m"]
    cell = plan["resolution_m"]
    axes.imshow([[shades[c] for c in row] for row in rows], cmap="gray", vmin=0, vmax=1, origin="lower", zorder=0,
                extent=(x, x + cell * len(rows[0]), y, y + cell * len(rows)))
    cells = np.array([cell for frontier in plan["frontiers"] for cell in frontier["cells_m"]]).reshape(-1, 2)
    frontiers, = axes.plot(*cells.T, "s", color="#ffcc80", markersize=3, zorder=1)
    return [(frontiers, "frontiers")]


def draw_paths(axes, plan, rows, shade):
    """To the candidates that were not rejected, by rank."""
    for row, colour in zip(rows, shade):
        corners = np.array(plan["paths_m"][int(row["candidate"])]).reshape(-1, 2)
        axes.plot(*corners.T, color=colour, linewidth=1.2)


def draw_candidates(axes, rows, count, shade, path):
    """Candidates from above, numbered by rank; returns what the legend says of them."""
    x, y, yaw = (numbers(rows, name, path) for name in ("x_m", "y_m", "yaw_rad"))
    entries = []
    if count < len(rows):
        rejected, = axes.plot(x[count:], y[count:], "x", color="#777777", markersize=6)
        entries.append((rejected, f"{len(rows) - count} rejected"))
    for i in reversed(range(count)):  # the best one on top
        axes.annotate("", (x[i] + 0.5 * math.cos(yaw[i]), y[i] + 0.5 * math.sin(yaw[i])), (x[i], y[i]),
                      arrowprops={"arrowstyle": "-|>", "color": shade[i], "linewidth": 1.6})
        axes.plot(x[i], y[i], "o", color=shade[i], markeredgecolor="black", markeredgewidth=0.5, markersize=6)
        axes.annotate(str(i + 1), (x[i], y[i]), xytext=(4, 4), textcoords="offset points", fontsize=8)
    others = [column for column in rows[0] if column.startswith(CHOSEN_BY)]
    rings = [("is_chosen", "o", ORANGE, "chosen")]
    rings += [(column, marker, colour, f"{column.removeprefix(CHOSEN_BY)} would choose")
              for column, (marker, colour) in zip(others, itertools.cycle(OTHER_METHODS))]
    for size, (column, marker, colour, name) in zip(itertools.count(15, 4), rings):
        chosen = [i for i, row in enumerate(rows) if row[column] == "1"]
        if chosen:
            ring, = axes.plot(x[chosen], y[chosen], marker, color="none", markeredgecolor=colour, markeredgewidth=1.8,
                              markersize=size)
            entries.append((ring, name))
    return entries


def draw_bars(panels, bars, rows, count, shade, path):
    """What each candidate that was not rejected costs and gives, by rank."""
    for panel, (column, name) in zip(panels, bars):
        panel.barh(np.arange(count), numbers(rows[:count], column, path), color=shade, height=0.7)
        panel.set_yticks(np.arange(count), np.arange(count) + 1, fontsize=8)
        panel.invert_yaxis()
        panel.set_title(name, fontsize=9)
        panel.locator_params(axis="x", nbins=3)
        panel.grid(axis="x", color="#dddddd", linewidth=0.6)
        panel.set_axisbelow(True)
    panels[0].set_ylabel("candidate, by utility")


def draw_decision(run):
    """What one decision was made from: where the candidates are, and what each one costs and gives."""
    path = run / DECISIONS
    table = read_table(path)
    if not table:
        raise MissingInput(f"{DECISIONS} holds no decision")
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    plan_of_then = read_decision_plan(run)
    try:
        rows, count = shown_decision(table, plan_of_then["decision"] if plan_of_then else with_most_candidates(table))
        number, method, time_s = rows[0]["decision"], rows[0]["method"], float(rows[0]["time_s"])
        explanation = next((row["explanation"] for row in rows if row.get("explanation")), "")  # older files have none
        bars = [bar for bar in DECISION_BARS if any(row[bar[0]] for row in rows)]  # not what the method does not ask for
        figure, (plan, *panels) = plt.subplots(1, 1 + len(bars), figsize=(13, 6.5),
                                               gridspec_kw={"width_ratios": [5] + [1] * len(bars)})
        shade = plt.get_cmap("viridis")(np.linspace(0.95, 0.05, count))
        entries = []
        if plan_of_then:
            entries = draw_floor_plan(plan, plan_of_then)
            draw_paths(plan, plan_of_then, rows, shade)
        gone = positions[stamps <= time_s]
        driven, = plan.plot(*gone[:, :2].T, color="black", linewidth=1.0)
        robot, = plan.plot(*gone[-1:, :2].T, "*", color="black", markersize=13)
        entries += draw_candidates(plan, rows, count, shade, path)
        draw_bars(panels, bars, rows, count, shade, path)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise MissingInput(f"{path.name} or {DECISION_PLAN} is damaged ({error})") from error
    plan.legend(*zip((driven, "path until then"), (robot, "robot"), *entries), loc="upper center",
                bbox_to_anchor=(0.5, -0.1), ncols=3, frameon=False)
    finish_plan(plan, "", has_map=bool(plan_of_then))
    map_of_then = ", with the map of then" if plan_of_then else ""
    figure.suptitle(f"Decision {number} at {time_s:.1f} s by method {method}, the one with most candidates{map_of_then}\n"
                    + textwrap.fill(explanation, 140), fontsize=10)
    figure.tight_layout()
    return figure


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
    finish_plan(axes, f"Trajectory in the map frame: {run.resolve().name}", has_map=points is not None)
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


def runs_of_equal(seconds, values):
    """(value, begin, end) of each stretch of equal values; the time before a row is that row's."""
    found = []
    begin = seconds[0]
    for i in range(1, len(values)):
        if i + 1 == len(values) or values[i + 1] != values[i]:
            found.append((values[i], begin, seconds[i]))
            begin = seconds[i]
    return found


def stretches(seconds, tiers, duration_s):
    """(tier, begin, end) of each stretch that one tier held; as in the shares of metrics.json, before the first frame and
    after the last one there is no pose."""
    found = [("none", 0.0, seconds[0])] if seconds[0] > 0 else []
    found += runs_of_equal(seconds, tiers)
    if duration_s > seconds[-1]:
        found.append(("none", seconds[-1], duration_s))
    return found


def distance_driven(run, seconds, path_m):
    """Distance by time and what it is by: truth, else the estimate."""
    if np.isfinite(path_m).any():
        return seconds, path_m, "true path"
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return stamps - stamps[0] + seconds[0], np.concatenate(([0.0], np.cumsum(steps))), "path by the estimate"


def metres(value, _):
    """A label of a logarithmic axis."""
    if value < 0.01:
        return f"{1000 * value:g} mm"
    return f"{100 * value:g} cm" if value < 1 else f"{value:g} m"


def draw_tiers(band, panels, held):
    """The band of tiers with their shares of the time; other panels are tinted where vision does not hold the pose."""
    for tier, begin, end in sorted(held, key=lambda stretch: list(TIERS).index(stretch[0])):  # the worst one on top,
        seen = {} if tier == "vision" else {"edgecolor": TIERS[tier], "linewidth": 0.8}  # and a single frame is seen, too
        band.axvspan(begin, end, facecolor=TIERS[tier], **seen)
        for axes in panels if tier != "vision" else ():
            axes.axvspan(begin, end, facecolor=TIERS[tier], edgecolor="none", alpha=0.18)
    whole = sum(end - begin for _, begin, end in held)
    shares = {name: sum(end - begin for tier, begin, end in held if tier == name) / whole for name in TIERS}
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=colour) for colour in TIERS.values()]
    band.legend(patches, [f"{'no pose' if name == 'none' else name} {100 * share:.1f} %" for name, share in shares.items()],
                loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=len(TIERS), frameon=False)
    band.set_ylabel("pose by", rotation=0, ha="right", va="center")
    band.set_yticks([])


def draw_sureness(axes, seconds, sigma_m, error_m):
    """How far slam thinks that it may be off, and how far it is."""
    for values, colour, name in ((sigma_m, BLUE, "sigma by slam"), (error_m, ORANGE, "error against the truth")):
        if np.isfinite(values).any():
            axes.plot(seconds, np.maximum(values, LEAST_SHOWN_M), color=colour, linewidth=1.5, label=name)
    axes.set_yscale("log")
    axes.set_ylim(LEAST_SHOWN_M, max(0.1, axes.get_ylim()[1]))
    axes.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(metres)
    axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_ylabel("position")
    axes.grid(which="both", color="#dddddd", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="upper left", framealpha=0.9)


def draw_explored(axes, band, run):
    """What share of the building is known, on an axis of its own, stretches without progress, and the planner's state in a
    band; nothing of what the run does not know."""
    path = run / "timeline.csv"
    rows = read_table(path) if path.is_file() else []
    band.set_yticks([])
    if len(rows) < 2:
        return band.set_visible(False)
    seconds = numbers(rows, "time_s", path)
    column = next((name for name in ("explored_share_with_margin", "explored_share")
                   if any(row.get(name) for row in rows)), None)
    if column:
        right = axes.twinx()
        right.plot(seconds, 100 * numbers(rows, column, path), color=ORANGE, linewidth=1.8)
        right.set_ylabel("explored [%]", color=ORANGE)
        right.set_ylim(0, 100)
    for is_stalled, begin, end in runs_of_equal(seconds, [row.get("is_stalled") == "1" for row in rows]):
        if is_stalled:
            axes.axvspan(begin, end, facecolor="none", edgecolor=GREY, hatch="///", linewidth=0)
            axes.annotate(f"no progress\n{end - begin:.0f} s", ((begin + end) / 2, 0.97), xycoords=("data", "axes fraction"),
                          ha="center", va="top", fontsize=8)
    states = [row.get("planner_state") or "" for row in rows]
    shown = [state for state in PLANNER_STATES if state in states]
    if not shown:
        return band.set_visible(False)
    for state, begin, end in runs_of_equal(seconds, states):
        if state in PLANNER_STATES:
            band.axvspan(begin, end, facecolor=PLANNER_STATES[state], edgecolor=PLANNER_STATES[state], linewidth=0.8)
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=PLANNER_STATES[state]) for state in shown]
    band.legend(patches, shown, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=len(shown), frameon=False)
    band.set_ylabel("planner", rotation=0, ha="right", va="center")


def draw_progress(run):
    """How far the robot has come and what it knows, what held its pose, what it did, and what that cost."""
    path = run / "frames.csv"
    rows = read_table(path)
    if len(rows) < 2:
        raise MissingInput("frames.csv holds no two frames")
    seconds, path_m, sigma_m, error_m = (numbers(rows, column, path) for column in
                                         ("time_s", "path_length_m", "position_sigma_m", "position_error_m"))
    tiers = [row.get("tier") for row in rows]
    if not np.isfinite(seconds).all() or not set(tiers) <= set(TIERS):
        raise MissingInput("frames.csv is damaged")
    figure, (distance, band, doing, sureness) = plt.subplots(
        4, 1, figsize=(11, 8), sharex=True, gridspec_kw={"height_ratios": [4, 0.45, 0.45, 4], "hspace": 0.4})
    at, driven_m, source = distance_driven(run, seconds, path_m)
    duration_s = metric(run, "duration_s") or seconds[-1]
    draw_tiers(band, (distance, sureness), stretches(seconds, tiers, duration_s))
    distance.plot(at, driven_m, color="black", linewidth=1.8)
    distance.set(ylabel=f"distance driven [m]\n({source})", title=f"Progress and pose: {run.resolve().name}")
    distance.set_ylim(bottom=0)
    distance.grid(color="#dddddd", linewidth=0.6)
    draw_explored(distance, doing, run)
    draw_sureness(sureness, seconds, sigma_m, error_m)
    sureness.set_xlabel("time since the first frame [s]")
    sureness.set_xlim(0, max(duration_s, seconds[-1]))
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


FIGURES = {"map.png": draw_classes, "trajectory.png": draw_trajectory, "pose_graph.png": draw_pose_graph,
           "coverage.png": draw_coverage, "errors.png": draw_errors, "progress.png": draw_progress,
           "class_iou.png": draw_class_iou, "decision.png": draw_decision}


def save(figure, path):
    """Written beside and renamed; without date or version, so that equal runs give equal pictures."""
    part = path.with_name(path.name + ".part")
    try:
        figure.savefig(part, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
        os.replace(part, path)
    finally:
        plt.close(figure)
        part.unlink(missing_ok=True)


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
        if draw is draw_decision and not (run / DECISIONS).exists():
            continue  # a run without a planner
        try:
            save(draw(run), folder / name)
            drawn += 1
        except MissingInput as missing:
            print(f"figures: {name} left out: {missing}", file=sys.stderr)
        except OSError as error:
            print(f"figures: {name} cannot be written: {error.strerror}", file=sys.stderr)
    return 0 if drawn else 1


if __name__ == "__main__":
    sys.exit(main())
