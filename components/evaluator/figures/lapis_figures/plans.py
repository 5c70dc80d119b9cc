"""Figures seen from above: map by class, trajectory, pose graph."""

import collections
import sys

import numpy as np
from matplotlib.collections import LineCollection

from lapis_figures.inputs import (ESTIMATE, TRUTH, MissingInput, class_names, metric, read_map, read_pose_graph,
                                  read_trajectory)
from lapis_figures.style import BLUE, ORANGE, break_gaps, plt

HEAD_ROOM_M = 0.5  # what lies higher above the camera (ceilings) would hide the rooms
MAX_CLASSES = 14  # in the legend of the map


class Grid:
    """Columns of voxels from above: cells of rows (y) and columns (x) that hold all positions [n, 3]."""

    def __init__(self, positions):
        steps = np.diff(np.unique(np.round(positions[:, 0], 4)))
        self.edge = steps.min() if len(steps) else 0.25
        self.low = positions[:, :2].min(axis=0)
        columns, rows = np.round((positions[:, :2].max(axis=0) - self.low) / self.edge).astype(int) + 1
        self.shape = rows, columns
        west, south = self.low - self.edge / 2
        self.extent = west, west + self.edge * columns, south, south + self.edge * rows

    def slenderness(self):
        """Height by width, but not a line."""
        return max(self.shape[0] / self.shape[1], 0.3)

    def cells(self, positions):
        """Rows and columns of positions."""
        columns, rows = np.round((positions[:, :2] - self.low) / self.edge).astype(int).T
        return rows, columns

    def image(self, positions, colours):
        """Each cell has the colour of its highest voxel [rows, columns, RGBA]."""
        order = np.argsort(positions[:, 2], kind="stable")  # the highest one comes last
        image = np.zeros((*self.shape, 4))
        image[self.cells(positions[order])] = np.column_stack((colours[order], np.ones(len(order))))
        return image

    def show(self, axes, image, **options):
        return axes.imshow(image, origin="lower", interpolation="nearest", extent=self.extent, **options)


def below(points, height_m):
    """What of positions, colours and labels is lower."""
    keep = points[0][:, 2] < height_m
    return tuple(values[keep] for values in points)


def draw_map(axes, points, paleness=0.0):
    """The map from above."""
    if len(points[0]):
        grid = Grid(points[0])
        grid.show(axes, grid.image(points[0], paleness + (1 - paleness) * points[1]))


def legend_of_classes(points, names):
    """Patches and names of the classes that are seen in most cells from above."""
    if not len(points[0]):
        return [], []
    order = np.argsort(points[0][:, 2], kind="stable")
    top = dict(zip(zip(*Grid(points[0]).cells(points[0][order])), order))
    cells_of = collections.Counter(int(points[2][i]) for i in top.values())
    colour_of = {int(points[2][i]): points[1][i] for i in top.values()}
    shown = sorted((label for label in cells_of if label in names), key=lambda label: (-cells_of[label], names[label]))
    return [plt.Rectangle((0, 0), 1, 1, facecolor=colour_of[label], edgecolor="#555555", linewidth=0.5)
            for label in shown[:MAX_CLASSES]], [names[label] for label in shown[:MAX_CLASSES]]


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
    points = below(points, positions[:, 2].mean() + HEAD_ROOM_M)
    draw_map(axes, points)
    axes.plot(*positions[:, :2].T, color="white", linewidth=2.4)
    driven, = axes.plot(*positions[:, :2].T, color="black", linewidth=1.2)
    start, = axes.plot(*positions[0, :2], "o", color="white", markeredgecolor="black", markersize=8)
    end, = axes.plot(*positions[-1, :2], "s", color="white", markeredgecolor="black", markersize=8)
    patches, names = legend_of_classes(points, class_names(run))
    axes.legend([driven, start, end, *patches], ["path of the robot", "start", "end", *names],
                loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    finish_plan(axes, f"Semantic map from above, without ceilings: {run.resolve().name}")
    return figure


def draw_trajectory(run):
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    figure, axes = plt.subplots(figsize=(10, 7.5))
    points = read_map(run / "map.ply")
    if points is None:
        print(f"figures: {run / 'map.ply'} is missing or unreadable; trajectory.png is drawn without the map",
              file=sys.stderr)
    else:
        draw_map(axes, below(points, positions[:, 2].mean() + HEAD_ROOM_M), paleness=0.45)
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
