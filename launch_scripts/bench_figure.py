#!/usr/bin/python3
"""Draws what decisions cost against the number of key-frames, from the results of two benchmarks.

usage: bench_figure.py PNG_FILE JSON_FILE...

The JSON files are those of lapis_planner_decision_benchmark and lapis_planner_spectral_benchmark, as written by
--benchmark_out.
"""

import sys

import matplotlib
import usage

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
from bench_table import read, time_ns  # noqa: E402

CURVES = {  # kernel: label, colour
    "decide": ("decision: 20 candidates, 10 views of 2,304 rays each", "#e65100"),
    "graph_and_landmarks": ("once per graph version: factor, landmarks", "#fb8c00"),
    "full_factorisation": ("D-optimality of a candidate, factorised from scratch", "#9e9e9e"),
    "whole_candidate": ("a candidate with 4 loops: D-optimality, gains, variances", "#64b5f6"),
    "dopt_candidate": ("D-optimality of a candidate, low-rank update", "#1565c0"),
}


def curves_of(files):
    """Points (key-frames, CPU time [ms]) by kernel."""
    points = {}
    for file in files:
        for name, result in read(file).items():
            kernel, _, size = name.partition("/")
            if kernel in CURVES:
                points.setdefault(kernel, []).append((int(size), 1e-6 * time_ns(result)))
    return points


def main():
    picture, *files = usage.arguments(__doc__, least=2)
    points = curves_of(files)
    if missing := [kernel for kernel in CURVES if kernel not in points]:
        sys.exit(f"bench_figure.py: none of the files has {', '.join(missing)}")
    figure, axes = plt.subplots(figsize=(9, 6.2))
    for kernel, (label, color) in CURVES.items():
        axes.loglog(*zip(*sorted(points[kernel])), "o-", color=color, linewidth=2, markersize=4, label=label)
    axes.set(xlabel="key-frames in the pose graph", ylabel="CPU time [ms]",
             title="Decisions and D-optimality against the size of the graph")
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.11), ncol=2, fontsize=9, frameon=False)
    figure.tight_layout()
    figure.savefig(picture, dpi=110)
    return 0


if __name__ == "__main__":
    sys.exit(main())
