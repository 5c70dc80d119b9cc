#!/usr/bin/python3
"""Draws what lapis_planner_graph_approximation --csv wrote: a loop's worth by the Laplacian and by the whole information.

usage: graph_approximation_figure.py CSV_FILE PNG_FILE
"""

import collections
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # pylint: disable=wrong-import-position


def read_loops(file):
    loops = collections.defaultdict(list)
    with open(file, newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            if row["what"] == "loop":
                loops[row["graph"]].append((float(row["laplacian"]), float(row["full"])))
    return loops


def draw(loops, file):
    figure, axes = plt.subplots(figsize=(7, 5), layout="constrained")
    colors = plt.get_cmap("tab20").colors
    for (graph, values), color in zip(loops.items(), colors * (1 + len(loops) // len(colors))):
        axes.plot(*zip(*values), ".", markersize=4, color=color, label=graph)
    ends = [min(min(pair) for values in loops.values() for pair in values),
            max(max(pair) for values in loops.values() for pair in values)]
    axes.plot(ends, ends, color="0.6", linewidth=1, zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="by the Laplacian [nats]",
             ylabel="by the whole information matrix, over 6 [nats]", title="What each loop adds to ln det")
    axes.legend(fontsize="x-small", ncols=2)
    figure.savefig(file, dpi=120)


def main():
    if len(sys.argv) != 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    draw(read_loops(sys.argv[1]), sys.argv[2])


if __name__ == "__main__":
    main()
