#!/usr/bin/env python3
"""Prints the table of benchmark.sh from the metrics.json of run folders, and writes it as CSV.

usage: benchmark_table.py CSV_FILE RUN_FOLDER...
"""

import csv
import json
import pathlib
import statistics
import sys

COLUMNS = {  # of the table: format, and what it shows of metrics.json
    "frames": ("{:.0f}", lambda m: m["frames_total"]),
    "lost": ("{:.0f}", lambda m: m["frames_total"] - m["frames_tracked"]),
    "ATE cm": ("{:.1f}", lambda m: 100 * m["ate_se3_rmse_m"]),
    "ATE origin cm": ("{:.1f}", lambda m: 100 * m["ate_origin_rmse_m"]),
    "IoU 8": ("{:.3f}", lambda m: m["iou_top8_mean"]),
    "map error cm": ("{:.1f}", lambda m: 100 * m["map_error_mean_m"]),
    "ideal IoU 8": ("{:.3f}", lambda m: m["ideal_iou_top8_mean"]),
    "ideal map error cm": ("{:.1f}", lambda m: 100 * m["ideal_map_error_mean_m"]),
    "contacts": ("{:.0f}", lambda m: m["collisions"]),
    "real-time factor": ("{:.2f}", lambda m: m["real_time_factor"]),
    "CPU s per s": ("{:.2f}", lambda m: sum(m["cpu_ms_per_frame"].values()) * m["frames_total"] / m["duration_s"] / 1e3),
}


def has_ended_well(folder):
    """benchmark.sh writes the file when the run has succeeded; a run that ended early has metrics, too."""
    return (folder / "identity").exists()


def row_of(folder):
    """Values of one run, by column; None where the run did not give one."""
    try:
        metrics = json.loads((folder / "metrics.json").read_text())
    except OSError:
        return dict.fromkeys(COLUMNS)
    row = {}
    for name, (_, value) in COLUMNS.items():
        try:
            row[name] = value(metrics)
        except (KeyError, TypeError):  # null: not defined for this run
            row[name] = None
    return row


def median_of(rows):
    def median(name):
        values = [row[name] for row in rows if row[name] is not None]
        return statistics.median(values) if values else None

    return {name: median(name) for name in COLUMNS}


def line(title, row):
    cells = ["-" if row[name] is None else form.format(row[name]) for name, (form, _) in COLUMNS.items()]
    return "| " + " | ".join([title, *cells]) + " |"


def main():
    target, folders = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    scenes, failed = {}, set()
    for folder in folders:
        scene, _, seed = folder.name.rpartition("_")
        scenes.setdefault(scene, {})[seed] = row_of(folder)
        if not has_ended_well(folder):
            failed.add((scene, seed))
    print("| scene, seed | " + " | ".join(COLUMNS) + " |")
    print("| --- |" + " --- |" * len(COLUMNS))
    for scene, rows in scenes.items():
        for seed, row in rows.items():
            print(line(f"{scene}, {seed}" + (" FAILED" if (scene, seed) in failed else ""), row))
        whole = [row for seed, row in rows.items() if (scene, seed) not in failed]
        print(line(f"{scene}, median of {len(whole)}", median_of(whole)))
    with target.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["scene", "seed", "failed", *COLUMNS])
        for scene, rows in scenes.items():
            writer.writerows([scene, seed, (scene, seed) in failed, *row.values()] for seed, row in rows.items())
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
