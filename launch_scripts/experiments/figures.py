"""Figures of experiment.sh beside its rows, as PNG, PDF and SVG: errors of all runs, what is explored over time and path,
IoU by class."""

import collections
import csv

import matplotlib
import numpy as np
from experiments.tables import has_failed, is_larger_better, name_of, value_of

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

COLORS = ("#1565c0", "#e65100", "#2e7d32", "#6a1b9a", "#b71c1c", "#00838f", "#5d4037", "#616161")
CLASSES = 10
PER_FIGURE = ("keyframe_ate_se3_rmse_m", "full_map_error_mean_m", "full_iou_top8_mean", "explored_share")
matplotlib.rcParams["svg.hashsalt"] = "lapis"  # equal rows, equal bytes


def colors_of(protocol):
    return {label: COLORS[i % len(COLORS)] for i, label in enumerate(protocol["methods"])}


def save(figure, folder, name):
    for extension in ("png", "pdf", "svg"):
        metadata = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(extension)
        figure.savefig(folder / f"{name}.{extension}", dpi=120, metadata=metadata)
    plt.close(figure)


def draw_runs(protocol, rows, folder):
    """A panel for each figure: boxes (quartiles, whiskers to the extremes), all runs, and how many failed."""
    wanted = [figure for figure in PER_FIGURE if any(row.get(figure) for row in rows)]
    if not wanted:
        return
    labels = list(protocol["methods"])
    figure, panels = plt.subplots(1, len(wanted), figsize=(3.2 * len(wanted), 1.8 + 0.5 * len(labels)), sharey=True,
                                  squeeze=False, layout="constrained")
    colors = colors_of(protocol)
    for axes, name in zip(panels[0], wanted):
        heading, factor, _ = name_of(name)
        for place, label in enumerate(labels):
            values = np.array([value_of(protocol, row, name) for row in rows if row["method"] == label])
            values = factor * values[np.isfinite(values)]
            if values.size:
                axes.boxplot(values, vert=False, positions=[place], widths=0.6, whis=(0, 100), manage_ticks=False,
                             medianprops={"color": colors[label], "linewidth": 2})
            axes.plot(values, [place] * len(values), ".", color=colors[label], alpha=0.7, zorder=3)
        axes.set_xlabel(heading + (" →" if is_larger_better(name) else " ←"))
        axes.grid(axis="x", color="#dddddd", linewidth=0.6)
    failed = {label: sum(has_failed(protocol, row) for row in rows if row["method"] == label) for label in labels}
    panels[0][0].set_yticks(range(len(labels)), [f"{label}\n({failed[label]} failed)" if failed[label] else label
                                                 for label in labels])
    panels[0][0].invert_yaxis()
    save(figure, folder, "runs")


def timelines_of(rows, folder):
    """By method: of each run, its timeline's columns as arrays."""
    groups = collections.defaultdict(list)
    for row in rows:
        file = folder / f"{row['key']}_{row['scene']}_{row['seed']}.csv"
        if not file.is_file():
            continue
        with file.open(newline="", encoding="utf-8") as stream:
            table = list(csv.DictReader(stream))
        columns = {name: np.array([float(line[name] or "nan") for line in table]) for name in table[0]} if table else {}
        if columns:
            groups[row["method"]].append(columns)
    return groups


def draw_progress(protocol, rows, folder, timelines):
    """Explored share over time and over path: median of the runs, and the band of 80 % of them."""
    groups = timelines_of(rows, timelines)
    if not groups:
        return
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.5), sharey=True, layout="constrained")
    for axes, column, text in zip(panels, ("time_s", "path_length_m"), ("time, s", "path, m")):
        end = max(run[column].max() for runs in groups.values() for run in runs)
        grid = np.linspace(0.0, end, 200)
        for label, color in colors_of(protocol).items():
            if not groups[label]:
                continue
            curves = 100 * np.array([np.interp(grid, run[column], run["explored_share"]) for run in groups[label]])
            low, middle, high = np.percentile(curves, (10, 50, 90), axis=0)
            axes.plot(grid, middle, color=color, label=label)
            axes.fill_between(grid, low, high, color=color, alpha=0.12, linewidth=0)
        axes.set(xlabel=text, ylim=(0, 100))
        axes.grid(color="#dddddd", linewidth=0.6)
    panels[0].set_ylabel("explored, % (a run that has ended keeps its last)")
    panels[0].legend(loc="lower right")
    save(figure, folder, "progress")


def draw_classes(protocol, rows, folder):
    """Mean IoU of the classes that most runs have, against the whole building."""
    of_classes = collections.Counter(key for row in rows for key in row if key.startswith("full_iou.") and row[key])
    names = [key for key, _ in sorted(of_classes.items(), key=lambda item: (-item[1], item[0]))[:CLASSES]]
    if not names:
        return
    labels = list(protocol["methods"])
    figure, axes = plt.subplots(figsize=(1.6 + 0.95 * len(names), 4.2), layout="constrained")
    width = 0.8 / len(labels)
    for i, (label, color) in enumerate(colors_of(protocol).items()):
        means = []
        for name in names:
            values = [float(row[name]) for row in rows if row["method"] == label and row.get(name)]
            means.append(100 * np.mean(values) if values else 0.0)
        axes.bar(np.arange(len(names)) + (i - 0.5 * (len(labels) - 1)) * width, means, width, color=color, label=label)
    axes.set_xticks(range(len(names)), [name.partition(".")[2] for name in names], rotation=30, ha="right")
    axes.set_ylabel("IoU with the whole building, %")
    axes.grid(axis="y", color="#dddddd", linewidth=0.6)
    axes.legend()
    save(figure, folder, "classes")


def draw(protocol, rows, folder):
    target = folder / "figures"
    target.mkdir(parents=True, exist_ok=True)
    draw_runs(protocol, rows, target)
    draw_classes(protocol, rows, target)
    draw_progress(protocol, rows, target, folder / "timelines")
