#!/usr/bin/env python3
"""Prints the table of benchmark.sh from run folders, and writes it as CSV; or prints it from what --table has kept.

usage: benchmark_table.py CSV_FILE RUN_FOLDER|CSV_FILE...
       benchmark_table.py --rows TABLE [KEY[/SCENE[/METHOD[/SEED]]]]...

CSV files that it wrote earlier, on other machines for example, may stand among the folders. What a run is of is in its
metrics.json and manifest.yaml; the names of folders say nothing.

TABLE is what benchmark.sh --table writes. Without a KEY (programs and configuration that made a row): of each method with
its world and settings the newest.
"""

import collections
import csv
import json
import math
import pathlib
import re
import statistics
import sys

import usage

NEVER = math.inf  # the time to reach what was not reached

COLUMNS = {  # of the table: format, and what it shows of metrics.json and simulation.yaml
    "explored %": ("{:.1f}", lambda m: 100 * m["explored_share"]),
    "explored with margin %": ("{:.1f}", lambda m: 100 * m["explored_share_with_margin"]),
    "80 % s": ("{:.0f}", lambda m: time_to(m, "time_to_80_s")),
    "90 % s": ("{:.0f}", lambda m: time_to(m, "time_to_90_s")),
    "no progress %": ("{:.1f}", lambda m: 100 * m["stalled_share"]),
    "failures": ("{:.0f}", lambda m: m["failures"]),
    "path m": ("{:.1f}", lambda m: m["path_length_m"]),
    "ATE raw cm": ("{:.1f}", lambda m: 100 * m["ate_raw_rmse_m"]),
    "ATE SE3 cm": ("{:.1f}", lambda m: 100 * m["ate_se3_rmse_m"]),
    "key-frame ATE SE3 cm": ("{:.1f}", lambda m: 100 * m["keyframe_ate_se3_rmse_m"]),
    "ATE at 80 m cm": ("{:.1f}", lambda m: 100 * m["ate_at_80_m"]),
    "map error cm": ("{:.1f}", lambda m: 100 * m["map_error_mean_m"]),
    "IoU 8": ("{:.3f}", lambda m: m["iou_top8_mean"]),
    "ideal map error cm": ("{:.1f}", lambda m: 100 * m["ideal_map_error_mean_m"]),
    "ideal IoU 8": ("{:.3f}", lambda m: m["ideal_iou_top8_mean"]),
    "full map error cm": ("{:.1f}", lambda m: 100 * m["full_map_error_mean_m"]),
    "full IoU 8": ("{:.3f}", lambda m: m["full_iou_top8_mean"]),
    "loops": ("{:.0f}", lambda m: m["loop_closures"]),
    "lost s": ("{:.1f}", lambda m: m["lost_time_s"]),
    "vision %": ("{:.1f}", lambda m: 100 * m["tier_vision_share"]),
    "surfaces %": ("{:.1f}", lambda m: 100 * m["tier_surfaces_share"]),
    "odometry %": ("{:.1f}", lambda m: 100 * m["tier_odometry_share"]),
    "lost %": ("{:.1f}", lambda m: 100 * m["lost_share"]),
    "contacts": ("{:.0f}", lambda m: m["collisions"]),
    "hardest push m/s": ("{:.2f}", lambda m: m["hardest_push_m_s"]),
    "decision p50 ms": ("{:.0f}", lambda m: 1e3 * m["decision_time_p50_s"]),
    "decision p95 ms": ("{:.0f}", lambda m: 1e3 * m["decision_time_p95_s"]),
    "real-time factor": ("{:.2f}", lambda m: m["real_time_factor"]),
    "CPU s per s": ("{:.2f}", lambda m: sum(m["cpu_ms_per_frame"].values()) * m["frames_total"] / m["duration_s"] / 1e3),
}


# What a row of benchmark.sh --table is of; its other columns are figures of metrics.json, a process's as cpu_ms_per_frame.slam.
LABELS = ("scene", "method", "seed", "world", "settings", "key", "commit", "outcome")


def time_to(metrics, key):
    """Where a share is known, and was not reached, the time to it is longer than any other."""
    if metrics["explored_share"] is None:
        return None
    return NEVER if metrics[key] is None else metrics[key]


def scene_name(facts):
    """A scene file by its name."""
    name = pathlib.PurePath(str(facts.get("scene") or facts.get("data_set") or "-")).name
    return name.removesuffix(".yaml")


def values_of(metrics):
    """By column; None where the metrics do not say."""
    def value(function):
        try:
            return float(function(metrics))
        except (KeyError, TypeError):  # null: not defined for this run
            return None

    return {name: value(function) for name, (_, function) in COLUMNS.items()}


class Run:
    """What a run is of, how it ended, and its values by column; None where it did not give one."""

    def __init__(self, of, outcome, commit, values):
        self.scene, self.method, self.seed = of
        self.outcome, self.commit, self.values = outcome, commit, values

    @property
    def has_failed(self):
        return self.outcome == "FAILED"


class FolderRun(Run):
    """A run whose folder is there."""

    def __init__(self, folder):
        self.folder = folder
        try:
            self.metrics = json.loads((folder / "metrics.json").read_text())
        except OSError:
            self.metrics = {}
        push = self._find("simulation.yaml", r"^hardest_push_m_s: (\S+)")
        if push is not None:
            self.metrics["hardest_push_m_s"] = float(push)
        of = self.metrics.get("run") or self._facts()
        super().__init__((scene_name(of), of.get("method", "tour"), str(of.get("seed", "-"))), self._outcome(),
                         of.get("commit"), values_of(self.metrics))

    def _facts(self):
        """Of a run without metrics."""
        section = self._find("manifest.yaml", r"^run:\n((?:  .*\n)*)") or ""
        return {name: value if value[0] != '"' else json.loads(value)
                for name, value in re.findall(r"^  (\w+): (.+)$", section, re.MULTILINE)}

    def _outcome(self):
        if not (self.folder / "identity").exists():  # written when the run has succeeded; others have metrics, too
            return "FAILED"
        if self.metrics["exit_reason"] == "lost":
            return "lost"
        names = {"DONE": "done", "GAVE_UP": "gave up", "FAILED": "planner failed", None: "completed"}
        if self.metrics["planner_state"] == "CONSOLIDATING":  # the planner's reason says how exploration ended
            return "gave up" if "what is left was tried in vain" in self.metrics["planner_reason"] else "done"
        return names.get(self.metrics["planner_state"], "time up")

    def _find(self, file, pattern):
        try:
            found = re.search(pattern, (self.folder / file).read_text(), re.MULTILINE)
        except OSError:
            return None
        return found and found[1]


def rows_of(file):
    """Runs of a CSV file that write_csv wrote."""
    if not file.is_file():
        sys.exit(f"{file}: no such file")
    with file.open(newline="") as stream:
        table = csv.DictReader(stream)
        missing = {"scene", "method", "seed", "outcome", "commit"} - set(table.fieldnames or ())
        if missing:
            sys.exit(f"{file}: no table of benchmark.sh, the column {min(missing)} is not there")
        if "key" in table.fieldnames:
            sys.exit(f"{file}: is a table of benchmark.sh --table; --rows prints it")
        for row in table:
            cells = {name: row.get(name) for name in COLUMNS}  # an older table has not all of them
            values = {name: NEVER if cell == "never" else float(cell) if cell else None for name, cell in cells.items()}
            yield Run((row["scene"], row["method"], row["seed"]), row["outcome"], row["commit"] or None, values)


def runs_of(paths):
    """Runs by (scene, method), in the order of the folders and CSV files."""
    groups = collections.defaultdict(list)
    for path in (pathlib.Path(path).absolute() for path in paths):
        if path.suffix != ".csv" and path.is_file():
            sys.exit(f"{path}: neither a run folder nor a CSV file")
        for run in rows_of(path) if path.suffix == ".csv" else [FolderRun(path)]:
            groups[run.scene, run.method].append(run)
    return groups


def read_table(file):
    """Columns and rows, as dictionaries of texts, of a table that benchmark.sh --table wrote; without either when there is
    none yet. Ends the script with status 2 when it is something else."""
    if not file.exists() or file.stat().st_size == 0:
        return [], []
    with file.open(newline="") as stream:
        table = csv.DictReader(stream)
        missing = set(LABELS) - set(table.fieldnames or ())
        if missing:
            print(f"{file}: no table of benchmark.sh --table, the column {min(missing)} is not there", file=sys.stderr)
            sys.exit(2)
        return list(table.fieldnames), list(table)


def id_of(row):
    """Which run a row is."""
    return f"{row['key']}/{row['scene']}/{row['method']}/{row['seed']}"


def metrics_of(row):
    """As in metrics.json, as far as the row has it."""
    metrics = {}
    for name, cell in row.items():
        if name in LABELS or not cell:
            continue
        try:
            value = float(cell)
        except ValueError:
            value = cell
        key, _, process = name.partition(".")
        if process:
            metrics.setdefault(key, {})[process] = value
        else:
            metrics[key] = value
    return metrics


def wanted_of(rows, ids):
    """The rows with one of the ids, or of what an id begins with; without ids the newest of each method in its world with
    its settings."""
    if ids:
        return [row for row in rows if any(f"{id_of(row)}/".startswith(f"{wanted}/") for wanted in ids)]
    newest = {(row["method"], row["world"], row["settings"]): row["key"] for row in rows}
    return [row for row in rows if newest[row["method"], row["world"], row["settings"]] == row["key"]]


def runs_of_rows(rows):
    """As runs_of; scenes are named with the world and, where it says which, the key."""
    groups = collections.defaultdict(list)
    keys = collections.defaultdict(set)
    for row in rows:
        keys[row["scene"], row["method"], row["world"]].add(row["key"])
    for row in rows:
        several = len(keys[row["scene"], row["method"], row["world"]]) > 1
        more = ", ".join(text for text in (row["world"], row["key"] if several else "") if text)
        run = Run((row["scene"] + (f" ({more})" if more else ""), row["method"], row["seed"]), row["outcome"],
                  row["commit"] or None, values_of(metrics_of(row)))
        groups[run.scene, run.method].append(run)
    return groups


def median_of(runs):
    def median(name):
        values = [run.values[name] for run in runs if run.values[name] is not None]
        return statistics.median(values) if values else None

    return {name: median(name) for name in COLUMNS}


def line(title, outcome, values, commit):
    cells = ["-" if values[name] in (None, NEVER) else form.format(values[name]) for name, (form, _) in COLUMNS.items()]
    return "| " + " | ".join([*title, outcome, *cells, commit or "-"]) + " |"


def print_table(groups):
    print("| scene | method | seed | outcome | " + " | ".join(COLUMNS) + " | commit |")
    print("|" + " --- |" * (len(COLUMNS) + 5))
    for (scene, method), runs in groups.items():
        for run in runs:
            print(line((scene, method, run.seed), run.outcome, run.values, run.commit))
        if len(runs) > 1:
            print_median(scene, method, runs)
    for (kind, method), of in generated_buildings(groups).items():
        if len(of) > 1:
            print_median(kind, method, [run for runs in of for run in runs])


def print_median(scene, method, runs):
    whole = [run for run in runs if not run.has_failed]
    outcomes = ", ".join(f"{n} {name}" for name, n in collections.Counter(run.outcome for run in runs).items())
    print(line((scene, method, f"median of {len(whole)}"), outcomes, median_of(whole), None))


def generated_buildings(groups):
    """The groups of runs by their kind, as clinic_* for clinic_7, and method."""
    kinds = collections.defaultdict(list)
    for (scene, method), runs in groups.items():
        kind, number = re.subn(r"^([a-z]+)_\d+\b", r"\1_*", scene)
        if number:
            kinds[kind, method].append(runs)
    return kinds


def write_csv(target, groups):
    with target.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["scene", "method", "seed", "outcome", "commit", *COLUMNS])
        for (scene, method), runs in groups.items():
            for run in runs:
                values = ["never" if value == NEVER else value for value in run.values.values()]
                writer.writerow([scene, method, run.seed, run.outcome, run.commit, *values])


def main():
    target, *sources = usage.arguments(__doc__, least=2)
    if target == "--rows":
        table = pathlib.Path(sources[0])
        if not table.is_file():
            sys.exit(f"{table}: no such file")
        _, rows = read_table(table)
        groups = runs_of_rows(wanted_of(rows, sources[1:]))
        if not groups:
            sys.exit(f"{sources[0]}: no such rows")
    else:
        groups = runs_of(sources)
        write_csv(pathlib.Path(target), groups)
    print_table(groups)
    return 1 if any(run.has_failed for runs in groups.values() for run in runs) else 0


if __name__ == "__main__":
    sys.exit(main())
