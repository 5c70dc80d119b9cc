#!/usr/bin/python3
"""Compares what paths promised with what the map gained while they were driven: a table, and a reliability plot.

usage: promise_table.py [PNG_FILE] RUN_FOLDER|CSV_FILE...     folders of explore.sh; files of lapis_explorations --paths

For each method: all paths and fifths of them by what they promised when they were chosen, each with the sums, their ratio
and, over all, Spearman's rank correlation. In the sums a path that was left for another one counts with what its views
had promised up to there, but its fifth is that of its whole promise: fifths by the part that was driven would gather in
the lowest one what was left at once. Paths of kind
`known` lead through what was known already (lapis_explorations --known), and of kind `driven` where they had led before:
of them, the mean difference per metre.
"""

import collections
import csv
import pathlib
import statistics
import sys

import usage

FIFTHS = 5
COLUMNS = ("method", "ended_kind", "ended_cost_m", "ended_promised_nats", "ended_driven_nats", "ended_gained_nats")

KNOWN = {"known": "known space", "driven": "driven before"}
Path = collections.namedtuple("Path", "kind cost_m whole_nats promised_nats gained_nats")


def paths_of(source):
    """(method, Path) of each path that ended; Path as the columns of decisions.csv say."""
    file = source / "decisions.csv" if source.is_dir() else source
    if not file.is_file():
        sys.exit(f"{file}: no such file; wanted is a run folder of explore.sh, or a file of lapis_explorations --paths")
    with file.open(newline="") as stream:
        table = csv.DictReader(stream)
        if not table.fieldnames:
            sys.exit(f"{file}: the file is empty; the run that writes it has ended no path yet, or was killed")
        if missing := set(COLUMNS) - set(table.fieldnames):
            sys.exit(f"{file}: the column {min(missing)} is not there; an older program wrote it")
        for row in table:
            if row["ended_kind"]:
                yield row["method"], Path(row["ended_kind"], *(float(row[name]) for name in COLUMNS[2:]))


def ranks(values):
    """From 0; equal values share the mean of theirs."""
    order = sorted(range(len(values)), key=values.__getitem__)
    result = [0.0] * len(values)
    begin = 0
    while begin < len(order):
        end = begin
        while end < len(order) and values[order[end]] == values[order[begin]]:
            end += 1
        for i in order[begin:end]:
            result[i] = (begin + end - 1) / 2
        begin = end
    return result


def spearman(paths):
    """Of promise and gain; nothing for fewer than three paths, or when all are equal."""
    columns = [ranks([path.promised_nats for path in paths]), ranks([path.gained_nats for path in paths])]
    if len(paths) < 3 or any(len(set(column)) == 1 for column in columns):
        return None
    return statistics.correlation(*columns)


def fifths(paths):
    """By the whole promise, equally many in each but for the rest."""
    paths = sorted(paths, key=lambda path: path.whole_nats)
    return [paths[i * len(paths) // FIFTHS:(i + 1) * len(paths) // FIFTHS] for i in range(FIFTHS)]


def cells(paths):
    promised, gained = (sum(getattr(path, name) for path in paths) for name in ("promised_nats", "gained_nats"))
    ratio = f"{gained / promised:.2f}" if promised > 0 else "-"
    return f"{len(paths)} | {promised:.0f} | {gained:.0f} | {ratio}"


def print_method(method, paths):
    new = [path for path in paths if path.kind not in KNOWN]
    correlation = spearman(new)
    print(f"| {method} | all | {cells(new)} | {'-' if correlation is None else f'{correlation:.2f}'} |")
    for group in filter(None, fifths(new)):
        print(f"| {method} | {group[0].whole_nats:.0f} to {group[-1].whole_nats:.0f} | {cells(group)} | |")
    for kind, name in KNOWN.items():
        known = [path for path in paths if path.kind == kind]
        if known:
            metres = sum(path.cost_m for path in known)
            difference = sum(abs(path.promised_nats - path.gained_nats) for path in known) / metres
            print(f"| {method} | {name}, {metres:.0f} m | {cells(known)} | {difference:.2f} nats per m apart |")


def draw(picture, methods):
    import matplotlib  # pylint: disable=import-outside-toplevel  (the table needs none)
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel
    figure, panels = plt.subplots(1, len(methods), figsize=(5.5 * len(methods), 5.5), squeeze=False)
    for axes, (method, paths) in zip(panels[0], methods.items()):
        new = [path for path in paths if path.kind not in KNOWN]
        axes.plot([path.promised_nats for path in new], [path.gained_nats for path in new], ".", color="#90caf9",
                  label="paths")
        groups = [group for group in fifths(new) if group]
        axes.plot([statistics.mean(path.promised_nats for path in group) for group in groups],
                  [statistics.mean(path.gained_nats for path in group) for group in groups], "o-", color="#1565c0",
                  label="means of fifths")
        limit = max([1.0] + [max(path.promised_nats, path.gained_nats) for path in new])
        axes.plot([1, limit], [1, limit], color="#9e9e9e", linewidth=1, label="as promised")
        axes.set(xscale="symlog", yscale="symlog", xlabel="promised [nat]", ylabel="gained [nat]", title=method)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.legend(loc="upper left", framealpha=0.9)
    figure.tight_layout()
    figure.savefig(picture, dpi=110)


def main():
    arguments = usage.arguments(__doc__, least=1)
    picture = arguments.pop(0) if arguments[0].endswith(".png") else None
    if not arguments:
        sys.exit("promise_table.py: no run folder and no CSV file")
    methods = collections.defaultdict(list)
    for source in arguments:
        for method, path in paths_of(pathlib.Path(source)):
            methods[method].append(path)
    if not methods:
        sys.exit("promise_table.py: no path ended in any of them")
    print("| method | when chosen [nat] | paths | promised by what was driven | gained | ratio | Spearman |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for method, paths in methods.items():
        print_method(method, paths)
    if picture:
        draw(picture, methods)
    return 0


if __name__ == "__main__":
    sys.exit(main())
