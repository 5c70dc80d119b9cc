#!/usr/bin/python3
"""Judges what lapis_planner_trials --rows wrote: a method against another, by pairs of missions in the same building.

usage: trials_table.py [--method METHOD[:THEN]] [--against METHOD[:THEN]] [--kinds] [--chance BUILDINGS] CSV_FILE...
       trials_table.py --methods CSV_FILE...
       trials_table.py --gains CSV_FILE...
       trials_table.py --runs CSV_FILE CSV_FILE...

For each figure: 90th percentile and median of both, their ratios, the upper end of the one-sided 90 % bootstrap interval
of each ratio (10,000 resamples of the buildings), and p of Wilcoxon's signed ranks (two-sided, of the logarithms of the
ratios). With --kinds, a table of medians for each kind of building, too. With --chance, how likely the bounds of decision
0053 are to hold when there are so many buildings of each kind, by drawing those that are missing from the pairs of
their kind (4,000 draws).

With --methods: key-frame ATE SE(3) of all methods, a line for each building.

With --gains: CSV_FILE has rows of lapis_planner_trials --gains. Decisions in a row that are for old places (or for
something else) are one drive, which promised what its first decision did.

With --runs: the trials beside runs in the same buildings in world W, a line each, and the means and medians of
both. CSV_FILE has rows of benchmark.sh (the whole chain by `lapis`), or of lapis_surviving_share (tours).
"""

import argparse
import csv
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[4] / "launch_scripts"))
from experiments import tables  # noqa: E402

FIGURES = {  # heading, factor, digits
    "ate_se3_m": ("key-frame ATE SE(3), cm", 100, 2),
    "ate_raw_m": ("key-frame ATE, first pose, cm", 100, 2),
    "lost": ("share of the map lost, %", 100, 2),
    "explored": ("explored, %", 100, 1),
    "path_m": ("path, m", 1, 1),
}
GAINED = ("path_m", "loops", "by_graph_nats", "true_nats")
GO_RATIO, GO_P = 0.75, 0.05  # bounds of decision 0053
DRAWS = 4000
NUMBERS = ("explored", "path_m", "ate_se3_m", "ate_raw_m", "surviving")


def read_csv(file):
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"{file}: {error.strerror}")


def read_whole(file, option, columns):
    """The rows of a file of lapis_planner_trials, which must have these columns, in lines that are complete."""
    rows = read_csv(file)
    missing = columns - set(rows[0] if rows else {})
    if missing:
        sys.exit(f"{file}: not written by lapis_planner_trials {option}, the column {min(missing)} is not there")
    for number, row in enumerate(rows, start=2):
        if None in row or None in row.values():
            sys.exit(f"{file}:{number}: the line has not as many cells as the header; is the file cut off?")
    return rows


def read_rows(file):
    rows = read_whole(file, "--rows", {"scene", "seed", "method", *NUMBERS})
    for row in rows:
        row.update({name: float(row[name]) for name in NUMBERS})
        row["lost"] = 1.0 - row["surviving"]
    return rows


def pairs_of(rows, method, against):
    """[(row of the method, row of the other)], by building and seed."""
    known = {(row["scene"], row["seed"], row["method"]): row for row in rows}
    keys = sorted({(row["scene"], row["seed"]) for row in rows})
    return [(known[*key, method], known[*key, against]) for key in keys
            if (*key, method) in known and (*key, against) in known]


def column(pairs, figure):
    return np.array([[row[figure] for row in pair] for pair in pairs])


def ratio_cells(values, share):
    """Both quantiles, their ratio, and the upper end of its one-sided 90 % interval."""
    ours, other = np.quantile(values, share, axis=0)
    picks = np.random.default_rng(1).integers(0, len(values), (tables.RESAMPLES, len(values)))
    resampled = np.quantile(values[picks], share, axis=1)
    upper = np.quantile(resampled[:, 0] / resampled[:, 1], 0.9)
    return ours, other, ours / other, upper


def table(pairs):
    lines = ["| figure | P90 | other's | ratio | upper end | median | other's | ratio | upper end | better in | p |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for figure, (heading, factor, digits) in FIGURES.items():
        values = column(pairs, figure)
        cells = [heading]
        for share in (0.9, 0.5):
            ours, other, ratio, upper = ratio_cells(values, share)
            cells += [f"{factor * ours:.{digits}f}", f"{factor * other:.{digits}f}", f"{ratio:.2f}", f"{upper:.2f}"]
        logs = np.log(np.maximum(values[:, 0], 1e-12) / np.maximum(values[:, 1], 1e-12))
        sign = -1 if figure == "explored" else 1
        cells += [str(int(np.sum(sign * logs < 0))), f"{tables.wilcoxon(logs):.4f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def summary(method, rows):
    """Loops, old places, and what of the map is lost in truth and by the graph, means over the missions."""
    lost, by_graph = (np.array([1.0 - float(row[name]) for row in rows]) for name in ("surviving", "predicted"))
    loops = np.mean([float(row["loops"]) for row in rows])
    revisits = np.mean([float(row["revisits"]) / float(row["decisions"]) for row in rows])
    return (f"{method}: {loops:.1f} loop closures, {100 * revisits:.0f} % of the decisions for old places; of the map "
            f"{100 * lost.mean():.1f} % lost, by the graph {100 * by_graph.mean():.1f} % "
            f"(r = {np.corrcoef(lost, by_graph)[0, 1]:.2f})")


def kinds_table(pairs):
    lines = ["| kind | missions | " + " | ".join(heading for heading, _, _ in FIGURES.values()) + " |",
             "| --- | --- |" + " --- |" * len(FIGURES)]
    kinds = sorted({pair[0]["scene"].rsplit("_", 1)[0] for pair in pairs})
    for kind in kinds:
        of_kind = [pair for pair in pairs if pair[0]["scene"].rsplit("_", 1)[0] == kind]
        cells = [kind, str(len(of_kind))]
        for figure, (_, factor, digits) in FIGURES.items():
            ours, other = factor * np.median(column(of_kind, figure), axis=0)
            cells.append(f"{ours:.{digits}f} / {other:.{digits}f}")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def chance_of_bounds(pairs, buildings):
    """Share of the draws in which the bound on the 90th percentile holds, and in which that of Wilcoxon's p does, too."""
    values = column(pairs, "ate_se3_m")
    kinds = np.array([pair[0]["scene"].rsplit("_", 1)[0] for pair in pairs])
    of_kinds = [values[kinds == kind] for kind in sorted(set(kinds))]
    random = np.random.default_rng(1)
    ratio_holds = both_hold = 0
    for _ in range(DRAWS):
        drawn = [known[random.integers(len(known), size=max(0, buildings - len(known)))] for known in of_kinds]
        ours, other = np.vstack([values, *drawn]).T
        if np.quantile(ours, 0.9) <= GO_RATIO * np.quantile(other, 0.9):
            ratio_holds += 1
            both_hold += tables.wilcoxon(np.log(ours / other)) < GO_P
    return ratio_holds / DRAWS, both_hold / DRAWS


def methods_table(rows):
    methods = list(dict.fromkeys(row["method"] for row in rows))
    lines = ["| building | " + " | ".join(methods) + " |", "| --- |" + " --- |" * len(methods)]
    for scene in sorted({row["scene"] for row in rows}):
        known = {row["method"]: row for row in rows if row["scene"] == scene}
        cells = [f"{100 * known[method]['ate_se3_m']:.2f}" if method in known else "" for method in methods]
        lines.append("| " + " | ".join([scene, *cells]) + " |")
    return lines


def read_gains(file):
    return read_whole(file, "--gains", {"scene", "seed", "method", "kind", "map_nats", "promised_nats", *GAINED})


def drives_of(rows):
    """Decisions in a row of one mission and kind, joined."""
    drives, before = [], None
    for row in rows:
        key = row["scene"], row["seed"], row["method"], row["kind"]
        if key != before:
            drives.append({"key": key, "promised_nats": float(row["promised_nats"]), **dict.fromkeys(GAINED, 0.0)})
        before = key
        for name in GAINED:
            drives[-1][name] += float(row[name])
        drives[-1]["map_nats"] = float(row["map_nats"])
    return drives


def gains_table(rows):
    """Sums over the drives of each building, method and kind, and over all buildings."""
    drives = drives_of(rows)
    lines = ["| building | method | drives | kind | path, m | loops | map, nats | promised, nats | by the graph | true |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    groups = {}
    for drive in drives:
        scene, _, method, kind = drive["key"]
        for name in (scene, "all"):
            groups.setdefault((name == "all", name, method, kind), []).append(drive)
    for (_, name, method, kind), own in sorted(groups.items()):
        maps = {drive["key"][:3]: drive["map_nats"] for drive in own}  # as of each mission's last drive
        numbers = [sum(drive[figure] for drive in own) for figure in ("path_m", "loops")]
        numbers += [sum(maps.values())]
        numbers += [sum(drive[figure] for drive in own) for figure in ("promised_nats", "by_graph_nats", "true_nats")]
        cells = [name, method, str(len(own)), kind, *(f"{number:.0f}" for number in numbers)]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


RUN_FIGURES = {  # heading, of trials, of runs, factor, digits
    "key-frame ATE SE(3), cm": ("ate_se3_m", "keyframe_ate_se3_rmse_m", 100, 2),
    "key-frame ATE, first pose, cm": ("ate_raw_m", "keyframe_ate_origin_rmse_m", 100, 2),
    "explored, %": ("explored", "explored_share", 100, 1),
    "90 % after, s": ("t90_s", "time_to_90_s", 1, 0),
    "path, m": ("path_m", "path_length_m", 1, 0),
    "loops": ("loops", "loop_closures", 1, 0),
}
TOUR_FIGURES = {
    "share of the map lost, %": ("lost", "lost", 100, 1),
    "key-frame ATE, first pose, cm": ("ate_raw_m", "ate_m", 100, 2),
    "path, m": ("path_m", "path_m", 1, 0),
    "loops": ("loops", "loops", 1, 0),
}


def read_runs(file):
    """{(building, seed): row} of runs of the whole chain by `lapis`, or of the ends of tours, in world W."""
    rows = [row for row in read_csv(file) if row.get("world") == "w" and row.get("method", "lapis") == "lapis"]
    if rows and "actual" in rows[0]:
        rows = [{**row, "lost": 1.0 - float(row["actual"])} for row in rows]
    return {(row["scene"], row["seed"]): row for row in rows}


def runs_table(rows, runs):
    pairs = [(row, runs[row["scene"], row["seed"]]) for row in rows if (row["scene"], row["seed"]) in runs]
    if not pairs:
        sys.exit("no trial is in a building and with a seed of these runs")
    figures = TOUR_FIGURES if "actual" in pairs[0][1] else RUN_FIGURES
    lines = ["| building | " + " | ".join(figures) + " |", "| --- |" + " --- |" * len(figures)]
    values = np.array([[[factor * float(row[of_trial]), factor * float(run[of_run] or "nan")]
                        for of_trial, of_run, factor, _ in figures.values()] for row, run in pairs])
    names = [row["scene"] for row, _ in pairs] + ["mean", "median"]
    for name, line in zip(names, [*values, values.mean(axis=0), np.median(values, axis=0)]):
        cells = [f"{ours:.{figure[3]}f} / {other:.{figure[3]}f}" for (ours, other), figure in zip(line, figures.values())]
        lines.append("| " + " | ".join([name, *cells]) + " |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="CSV_FILE")
    parser.add_argument("--method", default="expected:expected")
    parser.add_argument("--against", default="mi_only:nearest")
    parser.add_argument("--kinds", action="store_true", help="medians for each kind of building, too")
    parser.add_argument("--runs", metavar="CSV_FILE", help="runs to compare the trials with")
    parser.add_argument("--chance", type=int, metavar="BUILDINGS", help="of the bounds, with so many of each kind")
    parser.add_argument("--methods", action="store_true", help="all methods, a line for each building")
    parser.add_argument("--gains", action="store_true", help="what decisions promised, and what came of it")
    options = parser.parse_args()
    if options.gains:
        print("\n".join(gains_table([row for file in options.files for row in read_gains(file)])))
        return
    rows = [row for file in options.files for row in read_rows(file)]
    if options.methods:
        print("key-frame ATE SE(3), cm\n\n" + "\n".join(methods_table(rows)))
        return
    if options.runs:
        print("trial / run\n\n" + "\n".join(runs_table(rows, read_runs(options.runs))))
        return
    pairs = pairs_of(rows, options.method, options.against)
    if len(pairs) < 2:
        sys.exit(f"fewer than two buildings have missions of both {options.method} and {options.against}")
    print(f"{options.method} against {options.against}: {len(pairs)} pairs\n")
    print("\n".join(table(pairs)) + "\n")
    for method, rows_of_method in zip((options.method, options.against), zip(*pairs)):
        print(summary(method, rows_of_method))
    if options.kinds:
        print("\n" + "\n".join(kinds_table(pairs)))
    if options.chance:
        ratio, both = chance_of_bounds(pairs, options.chance)
        print(f"\nchance of at most {GO_RATIO} at P90 with {options.chance} buildings of each kind: {100 * ratio:.1f} %; "
              f"of p < {GO_P}, too: {100 * both:.2f} %")


if __name__ == "__main__":
    main()
