#!/usr/bin/env python3
"""CPU time of explorations per frame, by two builds in turns: what a change of the chain costs, or saves.

usage: ratio.py BASE CHANGED [--scenes NAME,...] [--duration S] [--rounds N] [--out DIR] [--set KEY=VALUE]...

BASE and CHANGED are checkouts whose build/release has the programs. In each round, both explore every scene; counted is
the CPU time of all processes from start to exit, evaluation and figures included, divided by the frames of the camera.
Machines differ from day to day, so only the ratio means something. The last column says whether both drove the same.

  --scenes NAME,...  default: apartment,large_building
  --duration S       simulated seconds, default 120
  --rounds N         default 3
  --out DIR          run folders and logs; default: out/chain
  --set KEY=VALUE    of CHANGED only; may be given several times

Exit status: 0 done, 1 a run failed, 2 bad set-up.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

TRAJECTORY = "trajectory_ground_truth.txt"


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n", maxsplit=1)[0], description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", type=pathlib.Path)
    parser.add_argument("changed", type=pathlib.Path)
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=["apartment", "large_building"])
    parser.add_argument("--duration", type=float, default=120.0)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/chain"))
    parser.add_argument("--set", action="append", default=[], dest="settings")
    options = parser.parse_args()
    for checkout in (options.base, options.changed):
        if not (checkout / "build/release/bin/lapis_simulator").is_file():
            parser.error(f"{checkout}: no build/release/bin/lapis_simulator; build it first")
    if options.rounds < 1:
        parser.error(f"--rounds {options.rounds}: wanted is 1 or more")
    return options


def cost_of(checkout, folder, scene, options, settings):
    """CPU milliseconds per frame; none, with a message, when the run fails."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    command = [str(checkout.resolve() / "launch_scripts/explore.sh"), "--scene", scene, "--duration", str(options.duration),
               "--out", str(folder.resolve())]
    for setting in settings:
        command += ["--set", setting]
    log = folder.with_suffix(".log")
    environment = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"} | os.environ
    environment.pop("LAPIS_BIN", None)
    with log.open("w", encoding="utf-8") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, env=environment)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        print(f"{scene} by {checkout} failed with status {process.returncode}; its log is {log}", file=sys.stderr)
        return None
    frames = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))["frames_total"]
    return 1e3 * (used.ru_utime + used.ru_stime) / frames


def play(options):
    costs = {scene: ([], []) for scene in options.scenes}
    print("| scene | round | base ms | changed ms | ratio | drove |\n| --- | --- | --- | --- | --- | --- |", flush=True)
    for number in range(1, options.rounds + 1):
        for scene in options.scenes:
            folders = [options.out / f"{scene}_{number}_{name}" for name in ("base", "changed")]
            base = cost_of(options.base, folders[0], scene, options, [])
            changed = base and cost_of(options.changed, folders[1], scene, options, options.settings)
            if not changed:
                return None
            costs[scene][0].append(base)
            costs[scene][1].append(changed)
            is_same = len({(folder / TRAJECTORY).read_bytes() for folder in folders}) == 1
            print(f"| {scene} | {number} | {base:.1f} | {changed:.1f} | {changed / base:.3f} | "
                  f"{'the same' if is_same else 'differently'} |", flush=True)
    return costs


def main():
    options = arguments()
    costs = play(options)
    if costs is None:
        return 1
    for scene, (base, changed) in costs.items():
        ratio = statistics.median(c / b for b, c in zip(base, changed))
        print(f"| {scene} | median | {statistics.median(base):.1f} | {statistics.median(changed):.1f} | {ratio:.3f} | |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
