#!/usr/bin/env python3
"""Keeps the table of benchmark.sh --table: a row for each run, with all its figures.

usage: benchmark_rows.py finished TABLE                   prints which runs have a row, but for those that failed
       benchmark_rows.py add TABLE RUN_FOLDER KEY/SCENE/METHOD/SEED WORLD SETTINGS

A row takes the place of one of the same run, and stands at the end; all others stay as they are.
"""

import contextlib
import csv
import fcntl
import os
import pathlib
import sys

import usage
from benchmark_table import LABELS, FolderRun, id_of, read_table

OF_PROCESSES = ("cpu_ms_per_frame", "peak_rss_mb")  # in metrics.json


def figures_of(metrics):
    """Columns and values: all of metrics.json but what the run is of, which has labels of its own, what is a sentence, and
    IoU by class, of which only that of the building's most frequent classes with the whole building is there."""
    figures = {}
    for key, value in metrics.items():
        if key in OF_PROCESSES:
            figures |= {f"{key}.{process}": figure for process, figure in (value or {}).items()}
        elif key == "full_iou_by_class":
            figures |= {f"full_iou.{name}": of["iou"] for name, of in (value or {}).items() if of["top8"]}
        elif key not in ("run", "planner_reason") and not key.endswith("iou_by_class"):
            figures[key] = value
    return figures


@contextlib.contextmanager
def lock(table):
    """For this process alone. Whoever replaces the file leaves others with a lock of what it was: they try again."""
    while True:
        with table.open("a") as stream:
            fcntl.flock(stream, fcntl.LOCK_EX)
            if table.exists() and os.path.samestat(os.fstat(stream.fileno()), table.stat()):
                yield
                return


def add(table, folder, run_id, world, settings):
    run = FolderRun(pathlib.Path(folder))
    key, scene, method, seed = run_id.split("/")
    row = dict(zip(LABELS, (scene, method, seed, world, settings, key, run.commit, run.outcome)))
    row |= figures_of(run.metrics)
    with lock(table):
        columns, rows = read_table(table)
        columns = list(dict.fromkeys([*(columns or LABELS), *row]))
        part = table.with_name(table.name + ".part")
        with part.open("w", newline="") as stream:
            writer = csv.DictWriter(stream, columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(other for other in rows if id_of(other) != run_id)
            writer.writerow(row)
        part.replace(table)


def main():
    command, table, *rest = usage.arguments(__doc__, least=2)
    table = pathlib.Path(table)
    if command == "finished" and not rest:
        for row in read_table(table)[1]:
            if row["outcome"] != "FAILED":
                print(id_of(row))
    elif command == "add" and len(rest) == 4:
        add(table, *rest)
    else:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
