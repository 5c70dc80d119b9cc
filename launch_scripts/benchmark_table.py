#!/usr/bin/env python3
"""Prints the table of benchmark.sh from run folders, and writes it as CSV.

usage: benchmark_table.py CSV_FILE RUN_FOLDER|CSV_FILE...

CSV files that it wrote earlier, on other machines for example, may stand among the folders. What a run is of is in its
metrics.json and manifest.yaml; the names of folders say nothing.
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
    "80 % s": ("{:.0f}", lambda m: time_to(m, "time_to_80_s")),
    "90 % s": ("{:.0f}", lambda m: time_to(m, "time_to_90_s")),
    "path m": ("{:.1f}", lambda m: m["path_length_m"]),
    "ATE raw cm": ("{:.1f}", lambda m: 100 * m["ate_raw_rmse_m"]),
    "ATE SE3 cm": ("{:.1f}", lambda m: 100 * m["ate_se3_rmse_m"]),
    "ATE at 80 m cm": ("{:.1f}", lambda m: 100 * m["ate_at_80_m"]),
    "map error cm": ("{:.1f}", lambda m: 100 * m["map_error_mean_m"]),
    "IoU 8": ("{:.3f}", lambda m: m["iou_top8_mean"]),
    "ideal map error cm": ("{:.1f}", lambda m: 100 * m["ideal_map_error_mean_m"]),
    "ideal IoU 8": ("{:.3f}", lambda m: m["ideal_iou_top8_mean"]),
    "loops": ("{:.0f}", lambda m: m["loop_closures"]),
    "lost s": ("{:.1f}", lambda m: m["lost_time_s"]),
    "contacts": ("{:.0f}", lambda m: m["collisions"]),
    "hardest push m/s": ("{:.2f}", lambda m: m["hardest_push_m_s"]),
    "decision p50 ms": ("{:.0f}", lambda m: 1e3 * m["decision_time_p50_s"]),
    "decision p95 ms": ("{:.0f}", lambda m: 1e3 * m["decision_time_p95_s"]),
    "unlike mi_only %": ("{:.0f}", lambda m: 100 * m["decisions_unlike_mi_only_share"]),
    "real-time factor": ("{:.2f}", lambda m: m["real_time_factor"]),
    "CPU s per s": ("{:.2f}", lambda m: sum(m["cpu_ms_per_frame"].values()) * m["frames_total"] / m["duration_s"] / 1e3),
}


def time_to(metrics, key):
    """Where a share is known, and was not reached, the time to it is longer than any other."""
    if metrics["explored_share"] is None:
        return None
    return NEVER if metrics[key] is None else metrics[key]


def scene_name(facts):
    """A scene file by its name."""
    name = pathlib.PurePath(str(facts.get("scene") or facts.get("data_set") or "-")).name
    return name.removesuffix(".yaml")


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
                         of.get("commit"), {name: self._value(function) for name, (_, function) in COLUMNS.items()})

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
        return {"DONE": "done", "FAILED": "gave up", None: "completed"}.get(self.metrics["planner_state"], "time up")

    def _value(self, function):
        try:
            return float(function(self.metrics))
        except (KeyError, TypeError):  # null: not defined for this run
            return None

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
        whole = [run for run in runs if not run.has_failed]
        outcomes = ", ".join(f"{n} {name}" for name, n in collections.Counter(run.outcome for run in runs).items())
        print(line((scene, method, f"median of {len(whole)}"), outcomes, median_of(whole), None))


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
    groups = runs_of(sources)
    print_table(groups)
    write_csv(pathlib.Path(target), groups)
    return 1 if any(run.has_failed for runs in groups.values() for run in runs) else 0


if __name__ == "__main__":
    sys.exit(main())
