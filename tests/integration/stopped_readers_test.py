#!/usr/bin/env python3
"""Readers of all topics that hang cost the others neither samples nor time, and the writers no memory: a recording is
played twice, the second time beside readers that are stopped after two seconds."""
import itertools
import signal
import statistics

import chain

WRITERS = ("sensor_replay", "slam", "semantic_mapper")
FRAME_OF_STOP = 30  # of 15 in a second
STOPPED_S = 8  # the lease of a participant is 3 s
LATER_S = 0.1  # by so much the p95 of the intervals between poses may be longer; a writer that waits for a reader takes 0.1 s
MORE_MB = 15  # histories keep what a reader has not acknowledged; images alone would be 80 MB
SLOWEST_S = 60


def memory_mb(process):
    """Resident memory of a process."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:")) / 1024


class Figures:
    """What a played recording has cost since FRAME_OF_STOP."""

    def __init__(self, lines, frames, grown_mb):
        arrivals = [float(line.split()[1]) for line in lines if line.startswith("arrived ") and line.endswith(" pose")]
        self.intervals_s = [b - a for a, b in itertools.pairwise(arrivals)]
        self.p95_s = statistics.quantiles(self.intervals_s, n=20)[-1]
        self.frames, self.grown_mb = frames, grown_mb


class StoppedReadersTest(chain.ChainTest):
    def start(self, folder, name, *arguments):
        process = chain.start(name, folder / f"{name}.log", *arguments)
        self.addCleanup(process.kill)
        return process

    def start_probe(self, folder, name):
        probe = chain.Process([chain.BIN / "lapis_stamp_probe"], folder / f"{name}.log")
        self.addCleanup(probe.kill)
        self.assertTrue(probe.wait_for_text("stamp_probe: ready"), probe.output())
        return probe

    def wait_for(self, probe, topic, frames):
        """Waits until the probe has that many samples of a topic."""
        def count(lines):
            found = sum(line.startswith(f"{topic} ") for line in lines)
            return found if found >= frames else None
        self.assertTrue(probe.wait_for(count, SLOWEST_S), f"less than {frames} samples of {topic}: {probe.output()}")

    def play(self, name, stops):
        """Plays the recording; True: the evaluator, which reads images, poses and map, and a probe of all else hang."""
        folder = self.folder / name
        folder.mkdir()
        probe = self.start_probe(folder, "probe")
        readers = [self.start_probe(folder, "other_probe"),
                   self.start(folder, "evaluator", "--set", f"evaluator.output_dir={folder}")]
        writers = [self.start(folder, "slam"), self.start(folder, "semantic_mapper")]
        writers.append(self.start(folder, "sensor_replay", chain.recording(), "--rate", "1", "--duration", str(2 + STOPPED_S),
                                  "--set", "sensor_replay.wait_for_readers=3"))
        self.wait_for(probe, "slam", FRAME_OF_STOP)
        before = {writer: memory_mb(writer) for writer in writers}
        begin = len(probe.lines())
        for reader in readers if stops else ():
            reader.send(signal.SIGSTOP)
        frames = 15 * (2 + STOPPED_S) - 5
        for topic in ("camera", "slam"):
            self.wait_for(probe, topic, frames)
        grown_mb = [memory_mb(writer) - before[writer] for writer in writers]
        figures = Figures(probe.lines()[begin:], frames, grown_mb)
        for reader in readers if stops else ():
            reader.send(signal.SIGCONT)
        for process in [*readers, *writers[:2], probe]:
            self.assertEqual(process.stop(), 0, process.output())
        return figures

    def test_readers_that_hang_cost_nobody_anything(self):
        alone, beside = self.play("alone", False), self.play("beside", True)
        more_mb = [b - a for a, b in zip(alone.grown_mb, beside.grown_mb)]
        print(f"figure: intervals between poses p95 {1e3 * alone.p95_s:.0f} ms, with readers that hang {1e3 * beside.p95_s:.0f} ms; "
              f"in {STOPPED_S} s memory grows by " + ", ".join(f"{mb:.1f}" for mb in more_mb) + f" MB more ({', '.join(WRITERS)})")
        self.assertLessEqual(beside.p95_s, alone.p95_s + LATER_S)
        self.assertLessEqual(max(more_mb), MORE_MB)


if __name__ == "__main__":
    chain.main()
