"""The map against the building: where it errs, and both side by side."""

import itertools

import numpy as np

from lapis_figures.inputs import ESTIMATE, MissingInput, class_names, metric, read_map, read_map_file, read_trajectory
from lapis_figures.plans import HEAD_ROOM_M, Grid, below, finish_plan, legend_of_classes
from lapis_figures.style import plt

# File, what it is, and prefix of its figures (docs/evaluation.md, references): the first one that a run has counts.
REFERENCES = (("ground_truth/full.lapis", "the whole building", "full_"),
              ("ground_truth/ideal.lapis", "the same frames without noise at true poses", "ideal_"),
              ("reference_map.lapis", "the same frames at true poses", ""))
FARTHEST_CELLS = 2  # larger errors have the last colour
NOT_EXPLORED = 0.9  # grey


def read_pair(run):
    """Voxels below the ceilings of the map and of its reference, what the reference is, and the prefix of its figures."""
    found = [entry for entry in REFERENCES if (run / entry[0]).is_file()]
    if not found:
        raise MissingInput(f"{REFERENCES[0][0]} is missing, and so are {', '.join(file for file, *_ in REFERENCES[1:])}")
    file, name, prefix = run / found[0][0], *found[0][1:]
    points = read_map(run / "map.ply")
    if points is None:
        raise MissingInput("map.ply is missing or unreadable")
    ceiling = read_trajectory(run / ESTIMATE)[1][:, 2].mean() + HEAD_ROOM_M
    pair = [below(of, ceiling) for of in (points, read_map_file(file))]
    if not all(len(positions) for positions, _, _ in pair):
        raise MissingInput(f"map.ply or {file.name} has nothing below the ceilings")
    return *pair, name, prefix


def offsets_by_length(farthest):
    """Steps in a grid up to a length [cells], the shortest first."""
    steps = range(-farthest, farthest + 1)
    lengths = [(np.hypot(np.hypot(*step[:2]), step[2]), step) for step in itertools.product(steps, repeat=3)]
    return sorted((length, step) for length, step in lengths if length <= farthest)


def distances(positions, reference, edge):
    """From each position to the nearest one of the reference [n, in metres], both on a grid of this edge [m], but at most
    FARTHEST_CELLS edges."""
    cells, others = (np.round((of - reference.min(axis=0)) / edge).astype(int) for of in (positions, reference))
    low, high = np.minimum(cells.min(axis=0), 0) - FARTHEST_CELLS, np.maximum(cells.max(axis=0), others.max(axis=0))
    taken = np.zeros(high - low + 1 + FARTHEST_CELLS, dtype=bool)
    taken[tuple((others - low).T)] = True
    found = np.full(len(cells), float(FARTHEST_CELLS))
    for length, step in reversed(offsets_by_length(FARTHEST_CELLS)):
        found[taken[tuple((cells - low + step).T)]] = length
    return edge * found


def draw_map_error(run):
    """The map from above: each cell shows the mean error of its voxels below the ceiling; pale is what only the building
    has."""
    points, reference, name, prefix = read_pair(run)
    grid = Grid(np.concatenate((points[0], reference[0])))
    errors_m = distances(points[0], reference[0], grid.edge)
    sums, counts = np.zeros(grid.shape), np.zeros(grid.shape)
    np.add.at(sums, grid.cells(points[0]), errors_m)
    np.add.at(counts, grid.cells(points[0]), 1)
    figure, axes = plt.subplots(figsize=(10, 2.0 + 8.0 * grid.slenderness()), layout="constrained")
    grid.show(axes, grid.image(reference[0], np.full((len(reference[0]), 3), NOT_EXPLORED)))
    means_cm = 100 * np.divide(sums, counts, out=np.full(grid.shape, np.nan), where=counts > 0)
    shown = grid.show(axes, means_cm, cmap="turbo", vmin=0.0, vmax=100 * grid.edge * FARTHEST_CELLS)
    figure.colorbar(shown, ax=axes, extend="max", label="to the nearest voxel of the reference [cm]\n(mean over height)")
    mean_m = metric(run, f"{prefix}map_error_mean_m")
    mean = "" if mean_m is None else f"mean of the whole map {100 * mean_m:.1f} cm; "
    finish_plan(axes, f"Error of the map below the ceilings: {run.resolve().name}\n{mean}reference: {name}")
    return figure


def colours_by_class(points, reference):
    """Those that the reference gives its classes; the map's own for classes that it has not."""
    of_class = dict(zip(reference[2].tolist(), reference[1]))
    return np.array([of_class.get(label, own) for label, own in zip(points[2].tolist(), points[1])])


def draw_beside_truth(run):
    """Explored map and reference from above, by height and by class."""
    points, reference, name, _ = read_pair(run)
    grid = Grid(np.concatenate((points[0], reference[0])))
    z = np.concatenate((points[0][:, 2], reference[0][:, 2]))
    by_height = plt.cm.ScalarMappable(plt.Normalize(z.min(), z.max()), "viridis")
    figure, panels = plt.subplots(2, 2, figsize=(13, 3.0 + 10.0 * grid.slenderness()), sharex=True, sharey=True,
                                  layout="constrained")
    for column, of in enumerate((points, reference)):
        grid.show(panels[0, column], grid.image(of[0], by_height.to_rgba(of[0][:, 2])[:, :3]))
        grid.show(panels[1, column], grid.image(of[0], colours_by_class(of, reference)))
    for axes, title in zip(panels.flat, ("explored, by height", "reference, by height", "explored, by class",
                                         "reference, by class")):
        finish_plan(axes, title)
        axes.label_outer()
    figure.colorbar(by_height, ax=panels[0], label="z [m]")
    patches, names = legend_of_classes(reference, class_names(run))
    if patches:
        panels[1, 1].legend(patches, names, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    figure.suptitle(f"Explored map beside its reference ({name}): {run.resolve().name}")
    return figure
