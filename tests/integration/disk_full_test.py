#!/usr/bin/env python3
"""No space left while a map is saved: the error is clear, the old file stays whole, the process continues. A run ends with
status 1 and the reason."""
import errno
import signal
import threading
import unittest
from pathlib import Path

import chain

DISK_SIZE = "16m"
MAP_FILES = ("map.lapis", "map.ot", "map.ply")


class SmallDisk:
    """A file system of its own in a mount namespace of its own: nothing stays mounted, whatever happens."""

    def __init__(self, folder, log):
        folder.mkdir()
        script = f'mount -t tmpfs -o size={DISK_SIZE} none "$1" && echo mounted && exec sleep infinity'
        command = ["unshare", "--mount", "--propagation", "private", "sh", "-c", script, "sh", folder]
        self.holder = chain.Process(command, log)
        self.is_mounted = self.holder.wait_for_text("mounted") is not None
        self.path = Path(f"/proc/{self.holder.pid}/root{folder}")
        self.enter = ["nsenter", f"--mount=/proc/{self.holder.pid}/ns/mnt"]

    def fill(self):
        try:
            with open(self.path / "ballast", "ab", buffering=0) as file:
                while True:
                    file.write(bytes(4096))
        except OSError as error:
            if error.errno != errno.ENOSPC:
                raise

    def clear(self):
        (self.path / "ballast").unlink()


class DiskFullTest(chain.ChainTest):
    """A small disk."""

    def setUp(self):
        self.disk = SmallDisk(self.folder / "disk", self.folder / "disk.log")
        self.addCleanup(self.disk.holder.kill)
        if not self.disk.is_mounted:
            print("SKIPPED: a tmpfs cannot be mounted here (needs root):", self.disk.holder.output())
            raise unittest.SkipTest("a tmpfs cannot be mounted here (needs root)")

    def started(self, process):
        self.addCleanup(process.kill)
        return process


class ProcessDiskFullTest(DiskFullTest):
    """One process on the small disk, and the probe."""

    def setUp(self):
        super().setUp()
        self.probe = self.started(chain.Process([chain.BIN / "lapis_stamp_probe"], self.folder / "probe.log"))
        self.assertTrue(self.probe.wait_for_text("stamp_probe: ready"), self.probe.output())

    def start_on_disk(self, name, *settings):
        """A process that writes on the small disk."""
        command = [*self.disk.enter, chain.BIN / f"lapis_{name}", "--set", f"{name}.output_dir={self.folder / 'disk'}"]
        for setting in settings:
            command += ["--set", setting]
        process = self.started(chain.Process(command, self.folder / f"{name}.log"))
        self.assertTrue(process.wait_for_text(f"{name}: ready"), process.output())
        return process

    def play(self, readers):
        self.started(chain.start("sensor_replay", self.folder / "sensor_replay.log", chain.recording(),
                                 "--rate", "1", "--set", f"sensor_replay.wait_for_readers={readers}"))


class MapperDiskFullTest(ProcessDiskFullTest):
    def setUp(self):
        super().setUp()
        self.mapper = self.start_on_disk("semantic_mapper", "semantic_mapper.save_period_s=1")
        self.started(chain.start("slam", self.folder / "slam.log"))
        self.play(readers=2)

    def integrated(self):
        """Number of frames in the newest map state."""
        counts = [int(line.split()[2]) for line in self.probe.lines() if line.startswith("semantic_mapper ")]
        return counts[-1] if counts else 0

    def wait_for_frames(self, count):
        self.assertTrue(self.probe.wait_for(lambda _: self.integrated() >= count, 30),
                        f"{self.integrated()} of {count} frames\n" + self.mapper.output())

    def save(self):
        """Answer of the service."""
        begin = len(self.probe.lines())
        self.probe.send(signal.SIGUSR1)
        answer = self.probe.wait_for(lambda lines: next((l for l in lines[begin:] if l.startswith("save ")), None), 30)
        self.assertIsNotNone(answer, self.probe.output())
        return answer

    def saved_map(self):
        """Bytes of map.lapis, which loads."""
        content = (self.disk.path / "map.lapis").read_bytes()
        copy = self.folder / "copy.lapis"
        copy.write_bytes(content)
        self.assertTrue(chain.is_map_whole(copy), "map.lapis does not load")
        return content

    def fill_until_saving_fails(self):
        for _ in range(10):  # a save that was under way frees space again when it ends: enough for the first file
            self.disk.fill()
            answer = self.save()
            if answer.startswith("save refused") and "map.lapis" in answer:
                return answer
        return self.fail(f"saving works on a full disk: {answer}")

    def test_disk_full(self):
        self.wait_for_frames(20)
        self.assertIn("save done", self.save())

        answer = self.fill_until_saving_fails()
        self.assertIn("No space left on device", answer)
        before = self.saved_map()
        frames = self.integrated()
        self.assertTrue(self.mapper.wait_for_text("mapping continues"), self.mapper.output())
        self.wait_for_frames(frames + 20)
        self.assertIn("save refused", self.save())
        self.assertEqual(self.saved_map(), before, "the old file has been touched")

        self.disk.clear()
        self.assertIn("save done", self.save())
        self.assertNotEqual(self.saved_map(), before)

        self.fill_until_saving_fails()
        self.assertEqual(self.mapper.stop(), 1, self.mapper.output())
        self.assertIn("No space left on device", self.mapper.lines()[-1])
        self.saved_map()
        self.assertEqual(sorted(path.name for path in self.disk.path.iterdir()), ["ballast", *MAP_FILES])


class SlamDiskFullTest(ProcessDiskFullTest):
    def setUp(self):
        super().setUp()
        self.slam = self.start_on_disk("slam", "slam.autosave_period_s=0.5")

    def saved_map(self):
        """Bytes of slam.lapis; lapis_slam takes the map, whatever it takes it for."""
        content = (self.disk.path / "slam.lapis").read_bytes()
        copy = self.folder / "copy.lapis"
        copy.write_bytes(content)
        with chain.start("slam", self.folder / "resumed.log", "--set", f"slam.resume_from={copy}"):
            return content

    def tracked(self):
        return len([line for line in self.probe.lines() if line.startswith("slam ")])

    def wait_until(self, condition, what):
        self.assertTrue(self.probe.wait_for(lambda _: condition(), 30), what + "\n" + self.slam.output())

    def test_disk_full(self):
        self.play(readers=1)
        file = self.disk.path / "slam.lapis"
        self.wait_until(file.exists, "no map is saved")
        self.disk.fill()
        self.wait_until(lambda: "slam.lapis" in self.slam.output() and "No space left" in self.slam.output(),
                        "saving works on a full disk")
        before, frames = self.saved_map(), self.tracked()
        self.wait_until(lambda: self.tracked() >= frames + 20, "tracking has stopped")
        self.assertEqual(file.read_bytes(), before, "the old file has been touched")

        self.disk.clear()
        self.wait_until(lambda: file.read_bytes() != before, "no map is saved although there is space again")
        self.disk.fill()
        self.assertEqual(self.slam.stop(), 1, self.slam.output())
        self.assertIn("No space left on device", self.slam.lines()[-1])
        self.saved_map()
        self.assertEqual(sorted(path.name for path in self.disk.path.iterdir()), ["ballast", "slam.lapis"])


class RunDiskFullTest(DiskFullTest):
    """explore.sh whose run folder is on the small disk."""

    def explore(self, *options):
        scene = self.folder / "flat.yaml"
        scene.write_text(chain.FLAT, encoding="utf-8")
        command = [*self.disk.enter, chain.REPOSITORY / "launch_scripts/explore.sh", "--scene", scene,
                   "--out", self.folder / "disk/run", "--method", "nearest", *options]
        return self.started(chain.Process(command, self.folder / "explore.log"))

    def fill_until_the_end(self, run):
        """Also what is freed meanwhile: a file that cannot be saved is removed."""
        is_kept_full = threading.Event()

        def fill():
            while not is_kept_full.wait(0.1):
                self.disk.fill()

        filler = threading.Thread(target=fill, daemon=True)
        filler.start()
        status = run.wait(90)
        is_kept_full.set()
        filler.join()
        return status

    def assert_nothing_is_half_written(self, run):
        self.assert_no_orphan(run)
        self.assertEqual([str(path) for path in self.disk.path.rglob("*.part")], [], run.output())
        self.assertNotIn(".part", run.output(), "a file that users do not know")

    def test_disk_full_while_it_explores(self):
        run = self.explore("--duration", "20")
        self.assertTrue(run.wait_for_text(" m driven", 60), run.output())
        self.assertEqual(self.fill_until_the_end(run), 1, run.output())
        self.assertIn(f"{self.folder}/disk/run/manifest.yaml: cannot be written: No space left on device", run.output())
        self.assertRegex(run.output(), r"explore.sh: \w+: failed with status 1; the end of ")
        self.assert_nothing_is_half_written(run)
        self.assertTrue((self.disk.path / "run/manifest.yaml").read_text(encoding="utf-8").startswith("version: "))

    def test_disk_full_before_it_begins(self):
        self.disk.fill()
        run = self.explore()
        self.assertEqual(run.wait(20), 2, run.output())
        self.assertIn(f"{self.folder}/disk/run/manifest.yaml: cannot be written: No space left on device", run.output())
        self.assert_nothing_is_half_written(run)


if __name__ == "__main__":
    chain.main()
