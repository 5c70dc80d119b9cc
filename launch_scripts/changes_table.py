#!/usr/bin/env python3
"""Prints how many decisions would have been others by another method, or with another prior occupancy of unknown voxels.

usage: changes_table.py RUN_FOLDER...     of explore.sh or benchmark.sh --set 'planner.compared_methods=[mi_only, paper]'
                                          or --set 'planner.compared_priors=[0.05, 0.1, 0.2, 0.5]'

Each decision is compared by itself: the same map, pose graph, candidates and goal that is being driven to (which counts
planner.keep_factor times), whatever the run did afterwards. Decisions without a candidate that can be driven to are
left out.
"""

import csv
import itertools
import pathlib
import sys

import usage

PREFIXES = {"is_chosen_by_": "", "is_chosen_with_prior_": "prior "}


def compared(columns):
    """What decisions are compared with, by column."""
    return {column: name + column.removeprefix(prefix) for prefix, name in PREFIXES.items() for column in columns
            if column.startswith(prefix)}


def changes_of(folder):
    """Number of decisions, and by what they are compared with how many of them it changes."""
    file = pathlib.Path(folder) / "decisions.csv"
    if not file.is_file():
        sys.exit(f"{file}: no such file; wanted is a run folder of explore.sh")
    with file.open(newline="") as stream:
        table = csv.DictReader(stream)
        others = compared(table.fieldnames or ())
        changes = dict.fromkeys(others.values(), 0)
        count = 0
        for _, candidates in itertools.groupby(table, lambda row: row["decision"]):
            chosen = [row for row in candidates if row["is_chosen"] == "1"]
            count += len(chosen)
            for column, name in others.items():
                changes[name] += sum(row[column] != "1" for row in chosen)
    if not changes:
        sys.exit(f"{folder}/decisions.csv compares nothing; explore with --set planner.compared_methods=[...], "
                 "or planner.compared_priors")
    return count, changes


def row(name, count, changes):
    shares = [f"{100 * number / count:.1f}" if count else "-" for number in changes.values()]
    return f"| {name} | {count} | " + " | ".join(shares) + " |"


def main():
    runs = {folder: changes_of(folder) for folder in usage.arguments(__doc__, least=1)}
    names = list(next(iter(runs.values()))[1])
    if any(list(changes) != names for _, changes in runs.values()):
        sys.exit("the runs do not compare the same methods or priors")
    print("| run | decisions | " + " | ".join(f"changed by {name} %" for name in names) + " |")
    print("| --- |" + " --- |" * (1 + len(names)))
    for folder, (count, changes) in runs.items():
        print(row(folder, count, changes))
    if len(runs) > 1:
        total = {name: sum(changes[name] for _, changes in runs.values()) for name in names}
        print(row("all", sum(count for count, _ in runs.values()), total))
    return 0


if __name__ == "__main__":
    sys.exit(main())
