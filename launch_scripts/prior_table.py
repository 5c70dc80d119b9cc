#!/usr/bin/env python3
"""Prints how many decisions would have been others with another prior occupancy of unknown voxels.

usage: prior_table.py RUN_FOLDER...     of explore.sh or benchmark.sh --set 'planner.compared_priors=[0.05, 0.1, 0.2, 0.5]'

Each decision is compared by itself: the same map, pose graph, candidates and goal that is being driven to (which counts
planner.keep_factor times), whatever the run did afterwards. Decisions without a candidate that can be driven to are
left out.
"""

import csv
import itertools
import pathlib
import sys

import usage

PREFIX = "is_chosen_with_prior_"


def changes_of(folder):
    """Number of decisions, and by prior how many of them it changes."""
    file = pathlib.Path(folder) / "decisions.csv"
    if not file.is_file():
        sys.exit(f"{file}: no such file; wanted is a run folder of explore.sh")
    with file.open(newline="") as stream:
        table = csv.DictReader(stream)
        changes = {name.removeprefix(PREFIX): 0 for name in table.fieldnames if name.startswith(PREFIX)}
        count = 0
        for _, candidates in itertools.groupby(table, lambda row: row["decision"]):
            chosen = [row for row in candidates if row["is_chosen"] == "1"]
            count += len(chosen)
            for prior in changes:
                changes[prior] += sum(row[PREFIX + prior] != "1" for row in chosen)
    if not changes:
        sys.exit(f"{folder}/decisions.csv compares no priors; explore with --set planner.compared_priors=[...]")
    return count, changes


def row(name, count, changes):
    shares = [f"{100 * number / count:.1f}" if count else "-" for number in changes.values()]
    return f"| {name} | {count} | " + " | ".join(shares) + " |"


def main():
    runs = {folder: changes_of(folder) for folder in usage.arguments(__doc__, least=1)}
    priors = next(iter(runs.values()))[1]
    if any(list(changes) != list(priors) for _, changes in runs.values()):
        sys.exit("the runs do not compare the same priors")
    print("| run | decisions | " + " | ".join(f"changed by {prior} %" for prior in priors) + " |")
    print("| --- |" + " --- |" * (1 + len(priors)))
    for folder, (count, changes) in runs.items():
        print(row(folder, count, changes))
    if len(runs) > 1:
        total = {prior: sum(changes[prior] for _, changes in runs.values()) for prior in priors}
        print(row("all", sum(count for count, _ in runs.values()), total))
    return 0


if __name__ == "__main__":
    sys.exit(main())
