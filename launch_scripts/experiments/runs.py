"""Plays the runs of an experiment, several side by side, and keeps a row of each."""

import csv
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import benchmark_rows
from experiments.protocol import ProtocolError, run_id, setting_of
from sources import REPOSITORY, programs

SCRIPTS = REPOSITORY / "launch_scripts"
LAST_DOMAIN = 101
TIMELINE = ("time_s", "path_length_m", "explored_volume_m3", "explored_share", "position_error_m")
TIMELINE_STEP = 5  # its lines are a second apart
BAD_SET_UP = 2  # exit status of explore.sh
FIGURES_OF_MAPS = ("map_error", "beside_truth")


def in_file_name(label):
    return re.sub(r"[^A-Za-z0-9_+-]", "_", label)


def text_of_duration(seconds):
    return f"{seconds // 3600:.0f} h {seconds % 3600 // 60:.0f} min" if seconds >= 3600 else f"{seconds / 60:.0f} min"


class Experiment:
    """The runs that have no row yet, some of them under way."""

    def __init__(self, protocol, todo, shown, rows, out, jobs):
        self.protocol, self.todo, self.rows, self.out, self.jobs = protocol, list(todo), rows, out, jobs
        self.settings = " ".join(setting_of(*setting) for setting in protocol["settings"].items())
        self.shown = shown  # the building whose maps are drawn
        self.first_domain = int(os.environ.get("ROS_DOMAIN_ID", "0"))
        self.cores = sorted(os.sched_getaffinity(0))
        self.under_way = {}  # by place: run, process, when it began
        self.count, self.failures, self.played_s, self.spent_s = len(self.todo), 0, 0.0, 0.0
        if self.first_domain + self.jobs - 1 > LAST_DOMAIN:
            raise ProtocolError(f"--jobs {jobs}: DDS domains from {self.first_domain} on, but the last one is {LAST_DOMAIN}")
        if self.jobs > len(self.cores):
            raise ProtocolError(f"--jobs {jobs}: there are {len(self.cores)} cores")

    def folder(self, run):
        return self.out / run.scene / in_file_name(run.label) / f"seed_{run.seed}"

    def begin(self, place, run):
        folder = self.folder(run)
        folder.parent.mkdir(parents=True, exist_ok=True)
        for name in ("identity", "metrics.json"):
            (folder / name).unlink(missing_ok=True)
        command = ["taskset", "-c", str(self.cores[place]), str(SCRIPTS / "explore.sh"), "--scene", run.scene, "--seed",
                   run.seed, "--out", str(folder), *run.arguments]
        with open(f"{folder}.log", "w", encoding="utf-8") as log:
            process = subprocess.Popen(  # pylint: disable=consider-using-with
                command, stdout=log, stderr=subprocess.STDOUT,
                env=os.environ | {"ROS_DOMAIN_ID": str(self.first_domain + place)})
        self.under_way[place] = run, process, time.monotonic()

    def end(self, place):
        run, process, began = self.under_way.pop(place)
        folder = self.folder(run)
        if process.returncode in (130, 143, -signal.SIGINT, -signal.SIGTERM):
            self.interrupt(process.returncode if process.returncode > 0 else 128 - process.returncode)
        if process.returncode == BAD_SET_UP:
            self.refuse(run)
        if process.returncode == 0:
            (folder / "identity").write_text(run_id(run) + "\n", encoding="utf-8")
        else:
            self.failures += 1
        self.rows.parent.mkdir(parents=True, exist_ok=True)
        benchmark_rows.add(self.rows, folder, run_id(run), self.protocol["world"] or "", self.settings)
        self.keep_timeline(run, folder)
        if process.returncode == 0 and run.scene == self.shown:
            self.keep_maps(run, folder)
        self.played_s += run.duration_s
        self.spent_s += time.monotonic() - began
        self.report(run, process.returncode)

    def keep_timeline(self, run, folder):
        """Every few seconds of it, beside the rows."""
        try:
            with (folder / "timeline.csv").open(newline="", encoding="utf-8") as stream:
                lines = list(csv.DictReader(stream))
        except OSError:
            return
        target = self.rows.parent / "timelines" / f"{run.key}_{run.scene}_{run.seed}.csv"
        target.parent.mkdir(exist_ok=True)
        kept = [line for i, line in enumerate(lines) if i % TIMELINE_STEP == 0 or i == len(lines) - 1]
        part = target.with_suffix(".part")
        with part.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, TIMELINE, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(kept)
        part.replace(target)

    def keep_maps(self, run, folder):
        """Its error, and the map beside the building, as figures."""
        script = programs() / "lapis_evaluator_figures.py"
        subprocess.run([script, folder, "--formats", "png", "pdf", "svg", "--only", *FIGURES_OF_MAPS], check=False)
        target = self.rows.parent / "figures"
        target.mkdir(exist_ok=True)
        for file in (folder / "figures").glob("*"):
            if file.stem in FIGURES_OF_MAPS:
                shutil.copyfile(file, target / f"{file.stem}_{run.scene}_{in_file_name(run.label)}_{run.seed}{file.suffix}")

    def report(self, run, status):
        waiting = self.todo + [other for other, _, _ in self.under_way.values()]
        left_s = sum(other.duration_s for other in waiting) * self.spent_s / self.played_s / self.jobs
        outcome = "done" if status == 0 else f"FAILED, status {status}, log {self.folder(run)}.log"
        failed = f", {self.failures} failed" if self.failures else ""
        print(f"[{self.count - len(waiting)}/{self.count}] {run.scene}, {run.label}, seed {run.seed}: {outcome}{failed}; "
              f"about {text_of_duration(left_s)} left", flush=True)

    def refuse(self, run):
        """What is wrong with one run is wrong with all of them, and says nothing about the method."""
        lines = pathlib.Path(f"{self.folder(run)}.log").read_text(encoding="utf-8", errors="replace").splitlines()
        print(f"experiment.sh: {run.scene}, {run.label}, seed {run.seed} cannot run as the protocol says; the end of "
              f"{self.folder(run)}.log: {lines[-1] if lines else 'nothing'}", file=sys.stderr)
        self.interrupt(BAD_SET_UP)

    def interrupt(self, status):
        """What is under way ends in order, and has no row."""
        for _, process, _ in self.under_way.values():
            process.terminate()
        for _, process, _ in self.under_way.values():
            process.wait()
        sys.exit(status)

    def play(self):
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, lambda number, _: self.interrupt(128 + number))
        while self.todo or self.under_way:
            for place in range(self.jobs):
                if place not in self.under_way and self.todo:
                    self.begin(place, self.todo.pop(0))
            time.sleep(0.2)
            for place in [place for place, (_, process, _) in self.under_way.items() if process.poll() is not None]:
                self.end(place)
