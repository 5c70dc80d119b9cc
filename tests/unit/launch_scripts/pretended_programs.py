"""A copy of the scripts with programs that only pretend: what tests of benchmark.sh and experiment.sh share."""
import json
import os
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(sys.argv.pop(1))
PROGRAMS = ("simulator", "sensor_replay", "recorder", "slam", "segmenter", "semantic_mapper", "planner", "controller", "evaluator")
# In place of the supervisor: notes what it was asked for, does what the test has told it to, and leaves metrics.
SUPERVISOR = """#!/usr/bin/env python3
import json, os, pathlib, signal, sys
home = pathlib.Path(__file__).parent
words = sys.argv[1:]
facts = dict(words[i + 1].split("=", 1) for i, word in enumerate(words) if word in ("--set", "--fact"))
folder = pathlib.Path(words[words.index("--out") + 1])
scene, seed = facts["simulator.scene"], int(facts["simulator.seed"])
method = facts.get("planner.method", "tour")
name = f"{pathlib.Path(scene).stem}/{method}/{seed}"
with (home / "played").open("a") as played:
    played.write(f"{name} {os.environ.get('ROS_DOMAIN_ID', '-')}\\n")
orders = json.loads((home / "orders").read_text())
if name in orders.get("slow", ()):  # until it is asked to end
    signal.signal(signal.SIGTERM, lambda *_: ((home / f"ended_{seed}").touch(), sys.exit(143)))
    (home / f"gate_{seed}").open("w").close()
    signal.pause()
if "meet" in orders:  # two that are there at the same time: each end of a pipe waits for the other
    (home / "gate").open("w" if int(os.environ["ROS_DOMAIN_ID"]) == orders["meet"] else "r").close()
folder.mkdir(parents=True, exist_ok=True)
if name in orders.get("rebuild", ()):
    (home / "lapis_slam").write_text("another one")
status = orders.get("status", {}).get(name, 0)
if status == 0:
    (folder / "metrics.json").write_text(json.dumps({
        "exit_reason": "completed", "planner_state": None, "lost_share": 0.25, "lost_time_s": seed,
        "collisions": None, "cpu_ms_per_frame": {"slam": 6.5, "planner": None}, "iou_by_class": {"wall": {"iou": 1}},
        "run": {"scene": scene, "method": method, "seed": seed, "commit": facts.get("commit")}} | orders.get("more", {})))
sys.exit(status)
"""
# In place of the evaluator's script: draws nothing, but leaves the files.
FIGURES = """#!/bin/sh
mkdir -p "$1/figures"
for name in map_error beside_truth; do echo a picture >"$1/figures/$name.png"; done
"""


class PretendedPrograms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for part in ("launch_scripts", "config"):
            shutil.copytree(REPOSITORY / part, self.folder / part)
        for part in ("common", "components", "idl", "bin"):
            (self.folder / part).mkdir()
        self.script("launch_scripts/benchmark_figures.py", "#!/bin/sh\n")
        for program in PROGRAMS:
            self.script(f"bin/lapis_{program}", f"#!/bin/sh\n# {program}\n")
        self.script("bin/lapis_supervisor", SUPERVISOR)
        self.script("bin/lapis_evaluator_figures.py", FIGURES)
        self.script("bin/git", "#!/bin/sh\necho 6007e82\n")  # which looks like a number
        for gate in ("gate", "gate_1", "gate_2"):
            os.mkfifo(self.folder / f"bin/{gate}")
        self.order()

    def script(self, name, text):
        file = self.folder / name
        file.write_text(text)
        file.chmod(0o755)

    def order(self, **orders):
        (self.folder / "bin/orders").write_text(json.dumps(orders))

    def environment(self):
        return {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", "LAPIS_BIN": str(self.folder / "bin"),
                "PYTHONDONTWRITEBYTECODE": "1", "ROS_DOMAIN_ID": "7"}
