#!/usr/bin/python3
"""Judges what lapis_surviving_share --rows wrote: the share of a map that survives, predicted and true.

usage: surviving_share_table.py [--tuning CSV_FILE] [--column predicted|predicted_wide] [--figure PNG_FILE] CSV_FILE

A line for each world: correlation over all snapshots and between runs (the last snapshot of each), mean and root mean
square of predicted less true share. With --tuning, beside them the error of a prediction from the path's length alone:
1 - a length^b, fitted by least squares to the last snapshots of that file.
"""

import argparse
import collections
import csv
import itertools
import math
import sys

import numpy as np

COLUMNS = {"scene", "world", "seed", "path_m", "actual", "predicted", "predicted_wide", "common"}


def read_rows(file):
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"{file}: {error.strerror}")
    if not rows:
        sys.exit(f"{file}: no rows")
    missing = COLUMNS - set(rows[0])
    if missing:
        sys.exit(f"{file}: not written by lapis_surviving_share --rows, the column {min(missing)} is not there")
    for number, row in enumerate(rows, start=2):
        if None in row or None in row.values():
            sys.exit(f"{file}:{number}: the line has not as many cells as the header; is the file cut off?")
    return rows


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def last_of_runs(rows):
    last = {}
    for row in rows:
        last[row["scene"], row["world"], row["seed"]] = row
    return list(last.values())


def correlation(a, b):
    return float(np.corrcoef(a, b)[0, 1]) if len(a) > 2 and np.std(a) > 0 and np.std(b) > 0 else math.nan


def fit_path(rows):
    """(a, b) of 1 - a length^b, on a grid of b."""
    lost, length = 1.0 - column(rows, "actual"), column(rows, "path_m")
    best = None
    for b in np.linspace(0.0, 2.0, 201):
        basis = length ** b
        a = float(basis @ lost / (basis @ basis))
        error = float(np.sum((lost - a * basis) ** 2))
        if best is None or error < best[0]:
            best = error, a, b
    return best[1:]


def line_of(world, rows, name, fitted):
    last = last_of_runs(rows)
    predicted, actual = column(rows, name), column(rows, "actual")
    error = predicted - actual
    cells = [world, len(last), len(rows), f"{actual.mean():.3f}", f"{correlation(predicted, actual):.2f}",
             f"{correlation(column(last, name), column(last, 'actual')):.2f}", f"{error.mean():+.3f}",
             f"{math.sqrt((error ** 2).mean()):.3f}", f"{correlation(column(rows, 'common'), actual):.2f}"]
    if fitted:
        of_path = 1.0 - fitted[0] * column(rows, "path_m") ** fitted[1]
        cells.append(f"{math.sqrt(((of_path - actual) ** 2).mean()):.3f}")
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def print_table(rows, name, fitted):
    head = ["world", "runs", "snapshots", "true share", "r", "r between runs", "bias", "rms error", "r of maps"]
    if fitted:
        head.append("rms error by path")
    print("| " + " | ".join(head) + " |")
    print("|" + " --- |" * len(head))
    worlds = collections.defaultdict(list)
    for row in rows:
        worlds[row["world"]].append(row)
    for world, of_world in sorted(worlds.items()):
        print(line_of(world, of_world, name, fitted))
    print(line_of("all", rows, name, fitted))
    if fitted:
        print(f"by path: 1 - {fitted[0]:.4g} length^{fitted[1]:.2f}")


def draw(rows, name, file):
    import matplotlib  # pylint: disable=import-outside-toplevel
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel
    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    for world, color in zip(sorted({row["world"] for row in rows}), itertools.cycle(("#1565c0", "#e65100", "#2e7d32"))):
        of_world = [row for row in rows if row["world"] == world]
        last = last_of_runs(of_world)
        axes.plot(column(of_world, name), column(of_world, "actual"), ".", color=color, markersize=4, alpha=0.5)
        axes.plot(column(last, name), column(last, "actual"), "o", color=color, markersize=6,
                  label=f"world {world}: the end of {len(last)} runs")
    low = min(column(rows, name).min(), column(rows, "actual").min()) - 0.02
    axes.plot([low, 1], [low, 1], color="0.6", linewidth=1, zorder=0)
    axes.set(xlabel="share that survives, predicted", ylabel="share that survives, by the true errors", aspect="equal")
    axes.legend()
    figure.savefig(file, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows")
    parser.add_argument("--tuning")
    parser.add_argument("--column", default="predicted", choices=["predicted", "predicted_wide"])
    parser.add_argument("--figure")
    options = parser.parse_args()
    rows = read_rows(options.rows)
    fitted = fit_path(last_of_runs(read_rows(options.tuning))) if options.tuning else None
    print_table(rows, options.column, fitted)
    if options.figure:
        draw(rows, options.column, options.figure)


if __name__ == "__main__":
    main()
