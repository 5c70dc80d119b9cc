"""What perturb.sh does; see its --help."""

import argparse
import csv
import fcntl
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys

try:
    import numpy as np

    from perturbations.kinds import KINDS, share_of_poor_shots
    from perturbations.sequence import SequenceError, read_sequence, write_sequence
    from sources import REPOSITORY, hash_of_sources, problem_of_programs, programs
except ModuleNotFoundError as missing:
    print(f"perturb.sh: no Python module {missing.name}; launch_scripts/setup.sh --dev installs what is needed", file=sys.stderr)
    sys.exit(2)

COLUMNS = ("sequence", "kind", "key", "frames", "tracked_share", "ate_se3_rmse_m", "cpu_ms_per_frame.slam", "poor_share",
           "named", "opencv_ate_m", "cpu_to_opencv")
OWN_SOURCES = ("launch_scripts/replay.sh", "launch_scripts/perturbations")
SEED = 1
MOST_POOR = 0.1  # of the frames; with more, nobody asks that the camera is tracked
LEAST_TRACKED = 0.95
MOST_TIMES_ATE = 2.0  # that of the sequence as it is


def parse():
    parser = argparse.ArgumentParser(prog="perturb.sh")
    parser.add_argument("sequences", nargs="+", type=pathlib.Path)
    parser.add_argument("--kinds", default="")
    parser.add_argument("--out", type=pathlib.Path, default=REPOSITORY / "out/perturbations")
    parser.add_argument("--results", type=pathlib.Path, default=REPOSITORY / "docs/results/perturbations.csv")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--set", action="append", default=[], dest="settings")
    options = parser.parse_args()
    options.kinds = [kind.strip() for kind in options.kinds.split(",") if kind.strip()] or list(KINDS)
    if unknown := [kind for kind in options.kinds if kind not in KINDS]:
        fail(f"--kinds: no such kind: {unknown[0]}; there are {', '.join(KINDS)}")
    return options


def fail(text):
    print(f"perturb.sh: {text}", file=sys.stderr)
    sys.exit(2)


def read_sequences(folders):
    sequences = [read_sequence(folder) for folder in folders]
    if of_its_own := [sequence.folder for sequence in sequences if "depth" in sequence.camera]:
        fail(f"{of_its_own[0]}/camera.yaml: depth: wanted is depth that is registered to colour")
    names = [sequence.name for sequence in sequences]
    if twice := [name for name in names if names.count(name) > 1]:
        fail(f"two sequences are called {twice[0]}: rows would not tell them apart")
    return sequences


class Run:
    """One sequence with one kind of images."""

    def __init__(self, sequence, kind, sources, options):
        self.sequence, self.kind, self.options = sequence, kind, options
        words = (sources, sequence.hash(), kind, *options.settings)
        self.key = hashlib.sha256("\0".join(words).encode()).hexdigest()[:16]
        name = "".join(c if c.isalnum() or c in "+-." else "_" for c in kind)
        self.data, self.folder = (options.out / of / sequence.name / name for of in ("data", "runs"))

    def __str__(self):
        return f"{self.sequence.name}, {self.kind}"

    def row(self, rows):
        """That of this run; none if it has not been played."""
        is_this = {"sequence": self.sequence.name, "kind": self.kind, "key": self.key}.items()
        return next((row for row in rows if is_this <= row.items()), None)

    def play(self):
        """Its row; none, with a message, when it failed."""
        for folder in (self.data, self.folder):
            folder.parent.mkdir(parents=True, exist_ok=True)
        camera, shots = KINDS[self.kind](self.sequence, np.random.default_rng(SEED))
        write_sequence(self.data, self.sequence, camera, shots)
        poor = share_of_poor_shots(read_sequence(self.data, fewest=1).shots())
        if status := self.replay():
            print(f"perturb.sh: {self}: replay.sh failed with status {status}, log {self.folder}.log", file=sys.stderr)
            return None
        try:
            metrics = json.loads((self.folder / "metrics.json").read_text(encoding="utf-8"))
            tracked = metrics["frames_tracked"] / metrics["frames_total"]
        except (OSError, ValueError, KeyError, TypeError, ZeroDivisionError) as problem:
            print(f"perturb.sh: {self}: {self.folder}/metrics.json does not say what was tracked ({problem})", file=sys.stderr)
            return None
        row = {"sequence": self.sequence.name, "kind": self.kind, "key": self.key, "frames": metrics["frames_total"],
                "tracked_share": round(tracked, 4), "ate_se3_rmse_m": metrics.get("ate_se3_rmse_m"),
                "cpu_ms_per_frame.slam": (metrics.get("cpu_ms_per_frame") or {}).get("slam"), "poor_share": round(poor, 4),
               "named": self.named(), **self.beside_opencv()}
        shutil.rmtree(self.data)
        return row

    def named(self):
        """What slam says is wrong with the camera."""
        try:
            log = (self.folder / "logs/slam.log").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""
        return "; ".join(re.findall(r"((?:depth|focal length) seems to be .*?)(?:,? \(edges|, /camera|: )", log))

    def beside_opencv(self):
        """Error of OpenCV's plain chain on the same images, and CPU of a tracked frame as a ratio to its own; empty where the
        program is not built or cannot play them."""
        program = programs() / "lapis_tracking_benchmark"
        if not program.is_file():
            return {}
        result = subprocess.run([program, "--sequence", self.data], capture_output=True, text=True, check=False)
        error = re.search(r"OpenCV ([\d.]+) cm$", result.stdout, re.MULTILINE)
        cost = re.search(r"^slam, tracking frame .* ([\d.]+)$", result.stdout, re.MULTILINE)
        return {"opencv_ate_m": round(float(error[1]) / 100, 4) if error else "", "cpu_to_opencv": cost[1] if cost else ""}

    def replay(self):
        """Status of replay.sh. Its interruption ends this script, and the other way round."""
        (self.folder / "metrics.json").unlink(missing_ok=True)
        command = ["setpriv", "--pdeathsig", "TERM", REPOSITORY / "launch_scripts/replay.sh", self.data, "--out", self.folder]
        command += [word for setting in self.options.settings for word in ("--set", setting)]
        with open(f"{self.folder}.log", "w", encoding="utf-8") as log, \
                subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT) as process:
            try:
                status = process.wait()
            except SystemExit:
                process.terminate()
                raise
        if status in (130, 143):
            sys.exit(status)
        return status


def read_rows(file):
    if not file.is_file():
        return []
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def add_row(file, row):
    """In place of one of the same sequence and kind with this key; all others stay."""
    is_this = {name: row[name] for name in ("sequence", "kind", "key")}.items()
    rows = [other for other in read_rows(file) if not is_this <= other.items()]
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(file.name + ".part")
    with part.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows([*rows, row])
    part.replace(file)


def make_folder(option, folder):
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        fail(f"{option}: {folder} cannot be made a folder ({problem.strerror}); choose another")
    if not os.access(folder, os.W_OK):
        fail(f"{option}: {folder} cannot be written; choose another")


def play(runs, options):
    """How many runs failed. The folder is this script's alone."""
    if problem := problem_of_programs():
        fail(problem)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    for option, place in (("--out", options.out), ("--results", options.results.parent)):
        make_folder(option, place)
    failures = 0
    folder = os.open(options.out, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        fail(f"{options.out} is in use by another perturb.sh; choose another with --out DIR")
    for number, run in enumerate(runs, 1):
        if run.row(read_rows(options.results)):
            continue
        row = run.play()
        failures += row is None
        if row:
            add_row(options.results, row)
            print(f"[{number}/{len(runs)}] {run}: {100 * row['tracked_share']:.1f} % tracked", flush=True)
    return failures


def text_of(row, column, factor, unit):
    return f"{factor * float(row[column]):.{2 if unit == 'cm' else 1}f} {unit}" if row.get(column) else "-"


def ratio(row, plain, column):
    value, of_plain = (float(of.get(column) or math.nan) for of in (row, plain))
    return f"{value / of_plain:.2f}" if of_plain > 0 and math.isfinite(value) else "-"


def misses(row, of_plain):
    """Which goals a row misses."""
    if float(row["poor_share"]) > MOST_POOR:
        return []
    times_ate = ratio(row, of_plain, "ate_se3_rmse_m")
    missed = {f"tracked < {100 * LEAST_TRACKED:.0f} %": float(row["tracked_share"]) < LEAST_TRACKED,
              f"ATE > {MOST_TIMES_ATE:.0f} x": times_ate != "-" and float(times_ate) > MOST_TIMES_ATE}
    return [goal for goal, is_missed in missed.items() if is_missed]


def print_table(runs, rows):
    """Errors and cost beside those of the sequence as it is, and what misses its goal. Whether enough frames are tracked."""
    print("| sequence | images | frames | tracked | ATE | ratio | OpenCV's chain | slam, CPU per frame | ratio | "
          "tracking, to OpenCV's chain | goal missed | slam says |\n"
          "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    plain = {run.sequence.name: run.row(rows) for run in runs if run.kind == "none"}
    is_tracked = True
    for run in runs:
        if not (row := run.row(rows)):
            continue
        of_plain = plain.get(run.sequence.name) or {}
        poor = "too dark, too bright, or without depth" if float(row["poor_share"]) > MOST_POOR else ""
        note = "; ".join(text for text in (poor, row.get("named")) if text)
        missed = misses(row, of_plain)
        is_tracked = is_tracked and not any(text.startswith("tracked") for text in missed)
        print(f"| {run.sequence.name} | {run.kind} | {row['frames']} | {text_of(row, 'tracked_share', 100, '%')} | "
              f"{text_of(row, 'ate_se3_rmse_m', 100, 'cm')} | {ratio(row, of_plain, 'ate_se3_rmse_m')} | "
              f"{text_of(row, 'opencv_ate_m', 100, 'cm')} | "
              f"{text_of(row, 'cpu_ms_per_frame.slam', 1, 'ms')} | {ratio(row, of_plain, 'cpu_ms_per_frame.slam')} | "
              f"{row.get('cpu_to_opencv') or '-'} | {', '.join(missed) or '-'} | {note} |")
    return is_tracked


def main():
    options = parse()
    failures = 0
    try:
        sources = hash_of_sources(OWN_SOURCES)
        runs = [Run(sequence, kind, sources, options) for sequence in read_sequences(options.sequences)
                for kind in options.kinds]
        if not options.table:
            failures = play(runs, options)
    except SequenceError as problem:
        fail(problem)
    except OSError as problem:  # for example a full disk
        print(f"perturb.sh: {problem}", file=sys.stderr)
        return 1
    is_tracked = print_table(runs, read_rows(options.results))
    return 0 if is_tracked and not failures else 1


if __name__ == "__main__":
    sys.exit(main())
