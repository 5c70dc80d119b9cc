"""What the integration tests share: the launcher, single processes, a recording and run folders.

Every process that a test starts carries the environment variable LAPIS_TEST_RUN with a value of its own, by which what
was left behind is found, and only such processes are ever ended.
"""
import contextlib
import fcntl
import functools
import json
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import uuid
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("LAPIS_BIN", REPOSITORY / "build/release/bin"))
COMPONENTS = ("slam", "semantic_mapper", "evaluator", "sensor_replay")
# A scene file: two rooms that are quickly explored.
FLAT = f"""labels: {REPOSITORY}/config/labels/mpcat40.yaml
rooms:
  - {{id: living, rect: [0, 0, 4, 3], floor: parquet, wall: wallpaper_leaves}}
  - {{id: hall, rect: [4.12, 0, 5.6, 3], floor: tiles, wall: brick}}
openings:
  - {{door: [4.06, 1.5]}}
pictures:
  - {{room: living, wall: south, x: 0.7}}
  - {{room: living, wall: west, y: 1.5}}
  - {{room: living, wall: north, x: 2.7}}
  - {{room: hall, wall: east, y: 1.5}}
starts:
  - {{at: [2, 1.2], yaw_deg: 90}}
"""
# The same, furnished, and a tour that comes back to where it was: what `recording` is made of.
FURNISHED_FLAT = FLAT + """furniture:
  - {class: sofa, room: living, wall: north, x: 1.2}
  - {id: table, class: table, size: [0.8, 0.5, 0.7], room: living, wall: west, y: 0.7}
  - {class: plant, on: table}
  - {class: chest_of_drawers, room: hall, wall: north, x: 5.1}
tour: [[2.8, 1.2], [2.4, 1.8], [2, 1.2], [2.8, 1.2]]
"""
NO_FURNITURE = ("--set", "simulator.world.furniture_folder=/nowhere")  # simple shapes: the same on every machine
# What a run folder has, and what of it is equal to the byte in a repeated run (docs/evaluation.md).
FILES = ("trajectory_estimate.txt", "trajectory_ground_truth.txt", "keyframes.txt", "pose_graph.g2o", "slam.lapis",
         "map.lapis", "map.ot", "map.ply", "reference_map.lapis", "timeline.csv", "frames.csv", "figures/map.png", "figures/map_error.png", "figures/beside_truth.png",
         "figures/trajectory.png", "figures/pose_graph.png", "figures/coverage.png", "figures/errors.png",
         "figures/progress.png")
FILES_OF_LABELS = ("figures/class_iou.png",)
FILES_OF_TRUTH = tuple(f"ground_truth/{name}" for name in ("mesh.lapis", "with_margin.lapis", "flood.lapis", "ideal.lapis",
                                                           "classes.json", "rooms.json", "navmap.png", "navmap.yaml"))
MEASURED_BY_THE_CLOCK = {"real_time_factor", "wall_time_s", "cpu_ms_per_frame", "peak_rss_mb", "decision_time_p50_s",
                         "decision_time_p95_s"}
SKIPPED = 77  # SKIP_RETURN_CODE of ctest


def main(needed=()):
    """Runs the tests of the calling module; skips them, loudly, where a file or folder that they need is missing."""
    missing = [str(folder) for folder in needed if not folder.exists()]
    if missing:
        print(f"SKIPPED: no recorded data at {', '.join(missing)}; set LAPIS_TEST_DATA to the folder that has it")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)


@functools.cache
def recording():
    """Folder of a labelled recording with ground truth, in the layout of the TUM RGB-D benchmark: the tour of
    FURNISHED_FLAT. It is kept beside the programs, and made when there is none yet or the simulator is newer."""
    folder = BIN.parent / "recordings/flat"
    folder.mkdir(parents=True, exist_ok=True)
    scene, made = folder / "flat.yaml", folder / "flat_tour"
    simulator = BIN / "lapis_simulator"
    with open(folder / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests may run at the same time
        newest = max(file.stat().st_mtime for file in (simulator, Path(__file__)))
        if not made.is_dir() or (made / "groundtruth.txt").stat().st_mtime < newest:
            scene.write_text(FURNISHED_FLAT, encoding="utf-8")
            part = folder / "part"
            for old in (part, made):
                shutil.rmtree(old, ignore_errors=True)
            subprocess.run([simulator, scene, "--export-tum", part, *NO_FURNITURE,
                            "--set", f"simulator.world.light_folder={folder / 'light'}"],
                           check=True, stdout=subprocess.DEVNULL, timeout=150)
            part.rename(made)
    return made


def color_model(folder, size, colors, names, labels):
    """A model file for the segmenter in a new folder. Its network finds the nearest of the `colors` (rgb each) in images of
    `size` (width, height); `names`: of their indices, in the label list `labels`."""
    folder.mkdir()
    width, height = size
    subprocess.run([BIN / "lapis_color_network", folder / "network.onnx", str(width), str(height),
                    *(str(value) for color in colors for value in color)], check=True)
    model = folder / "model.yaml"
    model.write_text("\n".join(
        ["network: network.onnx", f"labels: {labels}", f"input: {{width: {width}, height: {height}}}",
         "output: {values: labels}", "classes:", *(f"  {index}: {name}" for index, name in names.items()), ""]))
    return model


class Process:
    """A program whose output can be waited for. It is killed at the end of a `with` block and with the test."""

    def __init__(self, command, log, run=None):
        self.run = run or str(uuid.uuid4())
        self.log_file = Path(log)
        self.log_file.parent.mkdir(parents=True, exist_ok=True)
        self._lines = []
        self._grew = threading.Condition()
        self._has_ended = False
        # setpriv: a test that is killed takes its processes with it. The launcher ends its children on SIGTERM.
        words = ["setpriv", "--pdeathsig", "TERM", *map(str, command)]
        self._process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                         stderr=subprocess.STDOUT, text=True, errors="replace",
                                         env={**os.environ, "LAPIS_BIN": str(BIN), "LAPIS_TEST_RUN": self.run},
                                         start_new_session=True)
        self.pid = self._process.pid
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with open(self.log_file, "w", encoding="utf-8") as log:
            for line in self._process.stdout:
                log.write(line)
                log.flush()
                with self._grew:
                    self._lines.append(line.rstrip("\n"))
                    self._grew.notify_all()
        with self._grew:
            self._has_ended = True
            self._grew.notify_all()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()

    def lines(self):
        with self._grew:
            return list(self._lines)

    def output(self):
        return "\n".join(self.lines()) + f"\n({self.log_file})"

    def wait_for(self, find, seconds=20.0):
        """Waits until find(lines) is true and returns that; None at the deadline or at the end of the output."""
        with self._grew:
            self._grew.wait_for(lambda: self._has_ended or find(self._lines), timeout=seconds)
            return find(self._lines) or None

    def wait_for_text(self, text, seconds=20.0):
        return self.wait_for(lambda lines: next((line for line in lines if text in line), None), seconds)

    def is_alive(self):
        return self._process.poll() is None

    def send(self, number):
        self._process.send_signal(number)

    def wait(self, seconds=60.0):
        """Exit status (negative: the signal), with the whole output read; AssertionError at the deadline."""
        try:
            status = self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still runs after {seconds} s: {self.output()}") from None
        self._reader.join(seconds)
        return status

    def stop(self, number=signal.SIGTERM, seconds=20.0):
        self.send(number)
        return self.wait(seconds)

    def press_ctrl_c(self, seconds=20.0):
        """As on its terminal: every process of the foreground's group gets the signal."""
        os.killpg(self.pid, signal.SIGINT)
        return self.wait(seconds)

    def kill(self):
        if self.is_alive():
            self._process.kill()
        self._process.wait()
        self._reader.join(10)
        self._process.stdout.close()


def replay(dataset, out, *options, log=None):
    """launch_scripts/replay.sh, started; a text names a scene, a path a data set."""
    source = ["--scene", dataset] if isinstance(dataset, str) else [dataset]
    command = [REPOSITORY / "launch_scripts/replay.sh", *source, "--out", out, *options]
    return Process(command, log or f"{out}.log")


def start(component, log, *arguments, run=None):
    """One process of the chain, ready."""
    process = Process([BIN / f"lapis_{component}", *arguments], log, run)
    if not process.wait_for_text(f" {component}: ready"):
        process.kill()
        raise AssertionError(f"{component} is not ready: {process.output()}")
    return process


def processes_of(run):
    """Ids and program names of the living processes that carry the run's mark."""
    found = {}
    for folder in Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if folder.name.isdigit() and f"LAPIS_TEST_RUN={run}".encode() in (folder / "environ").read_bytes():
                found[int(folder.name)] = Path(os.readlink(folder / "exe")).name
    return found


def wait_until_gone(run, seconds=20.0):
    """Waits for the end of all processes with the run's mark; returns those that are left at the deadline."""
    end = time.monotonic() + seconds
    for pid in processes_of(run):
        with contextlib.suppress(ProcessLookupError):
            descriptor = os.pidfd_open(pid)
            select.select([descriptor], [], [], max(0.0, end - time.monotonic()))
            os.close(descriptor)
    return processes_of(run)


def metrics_of(folder):
    return json.loads((Path(folder) / "metrics.json").read_text(encoding="utf-8"))


def print_figures(name, metrics):
    for key, value in metrics.items():
        print(f"{name:24}{key:34}{value:.4f}" if isinstance(value, float) else f"{name:24}{key:34}{value}")


def is_map_whole(file):
    """True when the map loads, which compares its checksums."""
    command = [BIN / "lapis_evaluator", "coverage", "--estimate", file]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


class ChainTest(unittest.TestCase):
    """A test case with a folder of its own; what is in it is kept, and named, when a test fails."""

    def run(self, result=None):
        result = result or self.defaultTestResult()
        self.folder = Path(tempfile.mkdtemp(prefix="lapis_integration_"))
        problems = len(result.errors) + len(result.failures)
        super().run(result)
        if len(result.errors) + len(result.failures) > problems:
            print(f"logs and files are in {self.folder}", file=sys.stderr)
        else:
            shutil.rmtree(self.folder)
        return result

    def assert_no_orphan(self, process):
        self.assertEqual(wait_until_gone(process.run), {}, "processes left behind")

    def play(self, dataset, name, *options):
        """Plays a data set or a scene to the end, demands success and returns the run folder."""
        out = self.folder / name
        with replay(dataset, out, *options) as run:
            self.assertEqual(run.wait(120), 0, run.output())
            self.assert_no_orphan(run)
        return out

    def assert_same_run(self, one, other, files=FILES):
        """All that docs/evaluation.md promises to be equal."""
        differing = [file for file in files if (one / file).read_bytes() != (other / file).read_bytes()]
        self.assertEqual(differing, [], f"{one} and {other} differ")
        results = [{key: value for key, value in metrics_of(folder).items() if key not in MEASURED_BY_THE_CLOCK}
                   for folder in (one, other)]
        self.assertEqual(*results)
