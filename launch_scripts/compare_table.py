#!/usr/bin/env python3
"""Prints the table of compare.sh: runs of several variants side by side, and the differences to the first variant.

usage: compare_table.py VARIANT=RUN_FOLDER...

What a run is of is in its metrics.json and manifest.yaml; its folder's name says nothing.
"""

import collections
import pathlib
import random
import statistics
import sys

import usage
from benchmark_table import COLUMNS, FolderRun

CIRCUMSTANCES = {  # of a run: format, value
    "path m": ("{:.1f}", lambda m: m["path_length_m"]),
    "loops": ("{:.0f}", lambda m: m["loop_closures"]),
    "correction cm": ("{:.1f}", lambda m: 100 * m["correction_rmse_m"]),
    **{name: COLUMNS[name] for name in ("vision %", "surfaces %", "odometry %", "lost %")},
}
FIGURES = {  # of which differences are shown
    "ATE origin cm": ("{:.1f}", lambda m: 100 * m["ate_origin_rmse_m"]),
    "key-frame ATE SE3 cm": COLUMNS["key-frame ATE SE3 cm"],
    "IoU 8": ("{:.3f}", lambda m: m["iou_top8_mean"]),
    "map error cm": ("{:.2f}", lambda m: 100 * m["map_error_mean_m"]),
    "ideal IoU 8": ("{:.3f}", lambda m: m["ideal_iou_top8_mean"]),
    "ideal map error cm": ("{:.2f}", lambda m: 100 * m["ideal_map_error_mean_m"]),
}
RESAMPLES = 10_000


def runs_of(folders):
    """Of (variant, folder): metrics by scene or data set with its seed, then by variant, None for a run that is not there
    or has failed; and the folders of runs that have failed."""
    runs, failed = collections.defaultdict(lambda: dict.fromkeys(name for name, _ in folders)), []
    for name, folder in folders:
        run = FolderRun(pathlib.Path(folder))
        if run.has_failed:
            failed.append(run.folder)
        else:
            runs[run.scene if run.seed == "-" else f"{run.scene}_{run.seed}"][name] = run.metrics
    order = sorted(runs, key=lambda title: (title.rstrip("0123456789"), len(title), title))
    return {title: runs[title] for title in order}, failed


def value_of(metrics, function):
    try:
        return function(metrics)
    except (KeyError, TypeError):  # null, not there, or no run: not defined
        return None


def shown(form, value):
    return "-" if value is None else form.format(value)


def interval(differences):
    """95 % interval of the mean, by resampling runs with a fixed seed."""
    draw = random.Random(1)
    means = sorted(statistics.fmean(draw.choices(differences, k=len(differences))) for _ in range(RESAMPLES))
    return means[RESAMPLES // 40], means[-RESAMPLES // 40 - 1]


def print_runs(runs, variants):
    columns = CIRCUMSTANCES | FIGURES
    print("| run | variant | " + " | ".join(columns) + " |")
    print("| --- | --- |" + " --- |" * len(columns))
    for run, by_variant in runs.items():
        for name in variants:
            cells = [shown(form, value_of(by_variant[name], function)) for form, function in columns.values()]
            print(f"| {run} | {name} | " + " | ".join(cells) + " |")


def print_differences(runs, variants, title):
    base = variants[0]
    print(f"\n{title}: difference to {base}, mean [95 % bootstrap interval], least and largest\n")
    print("| figure | variant | runs | mean | interval | least | largest |")
    print("| --- |" + " --- |" * 6)
    for figure, (_, function) in FIGURES.items():
        for name in variants[1:]:
            pairs = [(value_of(r[base], function), value_of(r[name], function)) for r in runs.values()]
            differences = [b - a for a, b in pairs if a is not None and b is not None]
            if not differences:
                continue
            low, high = interval(differences)
            print(f"| {figure} | {name} | {len(differences)} | {statistics.fmean(differences):+.4f} "
                  f"| {low:+.4f} to {high:+.4f} | {min(differences):+.4f} | {max(differences):+.4f} |")


def main():
    folders = [argument.split("=", 1) for argument in usage.arguments(__doc__, least=2)]
    if any(len(pair) != 2 for pair in folders):
        sys.exit("compare_table.py: wanted is VARIANT=RUN_FOLDER (see --help)")
    variants = list(dict.fromkeys(name for name, _ in folders))
    runs, failed = runs_of(folders)
    print_runs(runs, variants)
    print_differences(runs, variants, "All runs")
    closed = {run: by_variant for run, by_variant in runs.items()
              if (value_of(by_variant[variants[0]], CIRCUMSTANCES["loops"][1]) or 0) > 0}
    if 0 < len(closed) < len(runs):
        print_differences(closed, variants, f"Runs in which {variants[0]} closed a loop")
    for run in failed:
        print(f"failed: {run}", file=sys.stderr)
    return 0 if all(m is not None for by_variant in runs.values() for m in by_variant.values()) and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
