#!/usr/bin/python3
"""Draws the figures of benchmark.sh: for each scene box plots, and the explored share over time, by method.

usage: benchmark_figures.py DIR RUN_FOLDER...     writes DIR/figures/SCENE_{boxes,coverage}.png
"""

import csv
import math
import pathlib
import sys

import matplotlib
import usage

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import numpy as np  # noqa: E402
from benchmark_table import runs_of  # noqa: E402

BOXES = ("explored %", "path m", "ATE raw cm", "map error cm", "IoU 8", "loops", "decision p95 ms")


def draw_boxes(scene, methods):
    """A panel for each figure, a box (quartiles, whiskers to the extremes) and all runs for each method."""
    figure, panels = plt.subplots(1, len(BOXES), figsize=(2.3 * len(BOXES), 1.6 + 0.5 * len(methods)), sharey=True)
    for axes, name in zip(panels, BOXES):
        values = [[run.values[name] for run in runs if not run.has_failed and run.values[name] is not None]
                  for runs in methods.values()]
        axes.boxplot(values, vert=False, whis=(0, 100), widths=0.6, medianprops={"color": "#e65100", "linewidth": 2})
        for row, of in enumerate(values, 1):
            axes.plot(of, [row] * len(of), ".", color="#1565c0", alpha=0.7, zorder=3)
        axes.set_title(name, fontsize=10)
        axes.grid(axis="x", color="#dddddd", linewidth=0.6)
        axes.locator_params(axis="x", nbins=4)
    labels = [f"{method} ({sum(not run.has_failed for run in runs)} of {len(runs)})" for method, runs in methods.items()]
    panels[0].set_yticks(range(1, len(methods) + 1), labels)
    panels[0].invert_yaxis()
    figure.suptitle(f"{scene}: median, quartiles, extremes and runs of each method (runs that did not fail)")
    figure.tight_layout()
    return figure


def share_over_time(run, seconds):
    """Explored share [%] at these times; a run that was over earlier keeps its last one. None without any."""
    with (run.folder / "timeline.csv").open(newline="") as stream:
        rows = [(float(row["time_s"]), 100 * float(row["explored_share"]))
                for row in csv.DictReader(stream) if row["explored_share"]]
    return np.interp(seconds, *zip(*rows), left=0.0) if rows else None


def draw_coverage(scene, methods):
    figure, axes = plt.subplots(figsize=(9, 5.5))
    longest = max((run.metrics["duration_s"] for runs in methods.values() for run in runs if not run.has_failed),
                  default=1.0)
    seconds = np.arange(0, math.ceil(longest) + 1)
    for method, runs in methods.items():
        shares = [share_over_time(run, seconds) for run in runs if not run.has_failed]
        shares = np.array([share for share in shares if share is not None])
        if not len(shares):
            continue
        middle, = axes.plot(seconds, np.median(shares, axis=0), linewidth=2, label=f"{method} ({len(shares)} runs)")
        axes.fill_between(seconds, shares.min(axis=0), shares.max(axis=0), color=middle.get_color(), alpha=0.15,
                          linewidth=0)
    axes.set(xlabel="simulated time [s]", ylabel="share of the explorable volume [%]",
             title=f"{scene}: explored share over time, median and extremes of the runs")
    axes.set_xlim(0, seconds[-1])
    axes.set_ylim(0, 100)
    axes.grid(color="#dddddd", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="lower right")
    figure.tight_layout()
    return figure


def main():
    folder, *sources = usage.arguments(__doc__, least=2)
    target = pathlib.Path(folder) / "figures"
    target.mkdir(exist_ok=True)
    scenes = {}
    for (scene, method), runs in runs_of(sources).items():
        scenes.setdefault(scene, {})[method] = runs
    for scene, methods in scenes.items():
        for name, draw in (("boxes", draw_boxes), ("coverage", draw_coverage)):
            figure = draw(scene, methods)
            figure.savefig(target / f"{scene}_{name}.png", dpi=110)
            plt.close(figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
