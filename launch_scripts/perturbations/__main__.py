"""What perturb.sh does; see its --help."""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

try:
    import numpy as np

    from experiments.protocol import REPOSITORY, hash_of_sources
    from perturbations.kinds import KINDS, share_of_poor_shots
    from perturbations.sequence import SequenceError, read_sequence, write_sequence
except ModuleNotFoundError as missing:
    sys.exit(f"perturb.sh: no Python module {missing.name}; launch_scripts/setup.sh --dev installs what is needed")

COLUMNS = ("sequence", "kind", "key", "frames", "tracked_share", "ate_se3_rmse_m", "cpu_ms_per_frame.slam", "poor_share")
SEED = 1
MOST_POOR = 0.1  # of the frames; with more, nobody asks that the camera is tracked


def parse():
    parser = argparse.ArgumentParser(prog="perturb.sh")
    parser.add_argument("sequences", nargs="+", type=pathlib.Path)
    parser.add_argument("--kinds", default="", help="comma-separated; default: all")
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


def in_file_name(kind):
    return "".join(c if c.isalnum() or c in "+-." else "_" for c in kind)


def read_rows(file):
    if not file.is_file():
        return []
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def write_rows(file, rows):
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(file.name + ".part")
    with part.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    part.replace(file)


def play(sequence, kind, key, options):
    """The row of a run; none when it failed."""
    name = sequence.folder.resolve().name
    data, run = (options.out / of / name / in_file_name(kind) for of in ("data", "runs"))
    data.parent.mkdir(parents=True, exist_ok=True)
    run.parent.mkdir(parents=True, exist_ok=True)
    camera, shots = KINDS[kind](sequence, np.random.default_rng(SEED))
    write_sequence(data, sequence, camera, shots)
    poor = share_of_poor_shots(read_sequence(data).shots())
    command = [REPOSITORY / "launch_scripts/replay.sh", data, "--out", run]
    command += [word for setting in options.settings for word in ("--set", setting)]
    with open(f"{run}.log", "w", encoding="utf-8") as log:
        status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=False,
                                env=os.environ | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}).returncode
    if status != 0:
        print(f"perturb.sh: {name}, {kind}: replay.sh failed with status {status}, log {run}.log", file=sys.stderr)
        return None
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    frames = metrics["frames_total"]
    return {"sequence": name, "kind": kind, "key": key, "frames": frames,
            "tracked_share": round(metrics["frames_tracked"] / frames, 4),
            "ate_se3_rmse_m": metrics["ate_se3_rmse_m"],
            "cpu_ms_per_frame.slam": (metrics.get("cpu_ms_per_frame") or {}).get("slam"), "poor_share": round(poor, 4)}


def play_all(sequences, key, options):
    """How many runs failed."""
    failures = 0
    todo = [(sequence, kind) for sequence in sequences for kind in options.kinds]
    for number, (sequence, kind) in enumerate(todo, 1):
        name = sequence.folder.resolve().name
        is_this = {"sequence": name, "kind": kind, "key": key}.items()
        if any(is_this <= row.items() for row in read_rows(options.results)):
            continue
        row = play(sequence, kind, key, options)
        failures += row is None
        if row is None:
            continue
        others = [other for other in read_rows(options.results) if not is_this <= other.items()]
        write_rows(options.results, [*others, row])
        print(f"[{number}/{len(todo)}] {name}, {kind}: {100 * row['tracked_share']:.1f} % tracked", flush=True)
    return failures


def number_of(row, column):
    return float(row[column]) if row.get(column) else float("nan")


def print_table(rows):
    """Errors and cost beside those of the sequence as it is."""
    of_none = {row["sequence"]: row for row in rows if row["kind"] == "none"}
    print("| sequence | images | frames | tracked | ATE | ratio | slam, CPU per frame | ratio | |\n"
          "| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for row in rows:
        plain = of_none.get(row["sequence"], {})
        ate, cpu = number_of(row, "ate_se3_rmse_m"), number_of(row, "cpu_ms_per_frame.slam")
        note = "too dark, too bright, or without depth" if number_of(row, "poor_share") > MOST_POOR else ""
        print(f"| {row['sequence']} | {row['kind']} | {row['frames']} | {100 * number_of(row, 'tracked_share'):.1f} % | "
              f"{100 * ate:.2f} cm | {ate / number_of(plain, 'ate_se3_rmse_m'):.2f} | {cpu:.1f} ms | "
              f"{cpu / number_of(plain, 'cpu_ms_per_frame.slam'):.2f} | {note} |")


def main():
    options = parse()
    failures = 0
    try:
        sequences = [read_sequence(folder) for folder in options.sequences]
        key = hash_of_sources()[:16]
        if not options.table:
            failures = play_all(sequences, key, options)
    except SequenceError as problem:
        fail(problem)
    names = [sequence.folder.resolve().name for sequence in sequences]
    rows = [row for row in read_rows(options.results) if row["key"] == key and row["sequence"] in names]
    print_table(sorted(rows, key=lambda row: (names.index(row["sequence"]), list(KINDS).index(row["kind"]))))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
