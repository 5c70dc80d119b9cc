#!/usr/bin/env python3
"""What it costs a run when slam, the mapper, or both are killed at a random instant and started again.

usage: kill_trials.py [--seeds FIRST-LAST] [--scene NAME] [--duration S] [--out DIR] [--table]

For each seed the robot explores the scene once undisturbed and once for each victim; seed and victim choose the instant
of the kill. Each trial is a row of kill_trials.csv in --out; trials that are in
it are not run again. Run it in a domain of its own: lapis_in_private_domain tests/faults/kill_trials.py ...

  --seeds FIRST-LAST  of the simulator, default 1-10
  --scene NAME        default flat_70
  --duration S        longest exploration in simulated seconds, default 150; a kill comes within the first 90
  --out DIR           run folders and rows; default out/kill_trials
  --table             print the table of the rows that are there, and run nothing

Exit status: 0 done, 1 a run failed, 2 bad set-up.
"""
import argparse
import csv
import os
import pathlib
import random
import re
import signal
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))
import chain  # noqa: E402

VICTIMS = {"none": (), "slam": ("slam",), "semantic_mapper": ("semantic_mapper",), "both": ("slam", "semantic_mapper")}
COLUMNS = ("scene", "limit_s", "seed", "victim", "killed_at_s", "duration_s", "planner_state", "map_error_mean_m", "explored_share",
           "keyframe_ate_se3_rmse_m", "keyframes", "ids_used_twice", "sessions")
KILLED_AT_S = (5.0, 90.0)
PROGRESS = re.compile(r"^(\d+) s, .* m driven")


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n", maxsplit=1)[0], description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="1-10", type=lambda text: range(int(text.split("-")[0]),
                                                                         int(text.split("-")[-1]) + 1))
    parser.add_argument("--scene", default="flat_70")
    parser.add_argument("--duration", default=150, type=int)
    parser.add_argument("--out", default=pathlib.Path("out/kill_trials"), type=pathlib.Path)
    parser.add_argument("--table", action="store_true")
    return parser.parse_args()


def wait_until(run, second):
    """Waits until the run has reached this simulated second."""
    def has_come(lines):
        seconds = [int(match[1]) for match in map(PROGRESS.match, lines) if match]
        return bool(seconds) and seconds[-1] >= second
    if not run.wait_for(has_come, 600):
        raise AssertionError(f"{second} s were not reached: {run.output()}")


def kill(run, names):
    """Kills these processes of the run at the same time."""
    pids = [pid for pid, name in chain.processes_of(run.run).items() if name in [f"lapis_{each}" for each in names]]
    if len(pids) != len(names):
        raise AssertionError(f"{names} are not running: {run.output()}")
    for pid in pids:
        os.kill(pid, signal.SIGKILL)


def row_of(options, seed, victim, killed_at_s, folder, probe):
    metrics = chain.metrics_of(folder)
    words = [line.split() for line in probe.lines()]
    ids = [word[2] for word in words if word[0] == "keyframe"]
    sessions = {word[2] for word in words if word[0] == "slam"}
    return {"scene": options.scene, "limit_s": options.duration, "seed": seed, "victim": victim,
            "killed_at_s": killed_at_s, **{key: metrics.get(key) for key in COLUMNS if key in metrics},
            "keyframes": len(ids), "ids_used_twice": len(ids) - len(set(ids)), "sessions": len(sessions)}


def trial(options, seed, victim):
    """Explores once, and returns the row."""
    folder = options.out.resolve() / f"{options.scene}_{seed}_{victim}"
    killed_at_s = random.Random(f"{seed} {victim}").uniform(*KILLED_AT_S) if VICTIMS[victim] else ""
    probe = chain.Process([chain.BIN / "lapis_stamp_probe"], folder.with_suffix(".probe.log"))
    command = [chain.REPOSITORY / "launch_scripts/explore.sh", "--scene", options.scene, "--seed", seed, "--duration",
               options.duration, "--out", folder, "--restart"]
    with probe, chain.Process(command, folder.with_suffix(".log")) as run:
        if not probe.wait_for_text("stamp_probe: ready"):
            raise AssertionError(probe.output())
        if VICTIMS[victim]:
            wait_until(run, killed_at_s)
            kill(run, VICTIMS[victim])
        if run.wait(1800) != 0:
            raise AssertionError(run.output())
        return row_of(options, seed, victim, killed_at_s, folder, probe)


def read_rows(file):
    if not file.is_file():
        return []
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def print_table(rows):
    """Each victim's map error, as a multiple of the undisturbed run's, and its explored share less that one [points]."""
    calm = {(row["scene"], row["limit_s"], row["seed"]): row for row in rows if row["victim"] == "none"}
    print(f"{'killed':16} {'trials':>6} {'error x, median':>16} {'worst':>6} {'share, median':>14} {'worst':>6} "
          f"{'ids twice':>9} {'sessions':>8}")
    for victim in (*(name for name in VICTIMS if VICTIMS[name]), "all"):
        pairs = [(row, calm[key]) for row in rows if row["victim"] not in ("none",) and victim in (row["victim"], "all")
                 if (key := (row["scene"], row["limit_s"], row["seed"])) in calm]
        if not pairs:
            continue
        errors = [float(row["map_error_mean_m"]) / float(base["map_error_mean_m"]) for row, base in pairs]
        shares = [100 * (float(row["explored_share"]) - float(base["explored_share"])) for row, base in pairs]
        print(f"{victim:16} {len(pairs):6} {statistics.median(errors):16.2f} {max(errors):6.2f} "
              f"{statistics.median(shares):+14.1f} {min(shares):+6.1f} {sum(int(row['ids_used_twice']) for row, _ in pairs):9} "
              f"{max(int(row['sessions']) for row, _ in pairs):8}")


def main():
    options = arguments()
    file = options.out / "kill_trials.csv"
    rows = read_rows(file)
    done = {(row["scene"], row["limit_s"], row["seed"], row["victim"]) for row in rows}
    wanted = [(seed, victim) for seed in options.seeds for victim in VICTIMS
              if (options.scene, str(options.duration), str(seed), victim) not in done]
    for number, (seed, victim) in enumerate([] if options.table else wanted, 1):
        print(f"trial {number} of {len(wanted)}: seed {seed}, killed: {victim}", flush=True)
        try:
            row = trial(options, seed, victim)
        except AssertionError as error:
            print(f"kill_trials.py: {error}", file=sys.stderr)
            return 1
        is_new = not file.is_file()
        with file.open("a", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, COLUMNS)
            if is_new:
                writer.writeheader()
            writer.writerow(row)
    print_table(read_rows(file))
    return 0


if __name__ == "__main__":
    sys.exit(main())
