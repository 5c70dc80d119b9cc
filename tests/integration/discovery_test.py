#!/usr/bin/env python3
"""Many processes on one host find each other, and those that come and go all the time cost the others no sample."""
import os
import signal
import time

import chain

PAIRS = 16  # so many writers and so many readers: 32 processes, what docs/ros2.md promises for a host
ALL_FOUND_WITHIN_S = 30.0  # on two cores that others use, too
IDLE_CPU_PERCENT = 5.0
IDLE_S = 5  # as many reports of each writer
JOINS_PER_S = 10
PLAYED_WITHIN_S = 40.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def cpu_s(process):
    """CPU time of a process so far."""
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


class DiscoveryTest(chain.ChainTest):
    def started(self, name, *command):
        process = chain.Process(command, self.folder / f"{name}.log")
        self.addCleanup(process.kill)
        return process

    def start_probe(self, name):
        return self.started(name, chain.BIN / "lapis_stamp_probe")

    def assert_found(self, reader, writers, deadline):
        """The reader has reports of so many writers."""
        def names(lines):
            found = {line.split()[4] for line in lines if line.startswith("diagnostics ")}
            return found if len(found) >= writers else None
        self.assertTrue(reader.wait_for(names, max(0.0, deadline - time.monotonic())), reader.output())

    def test_thirty_two_processes_find_each_other(self):
        began = time.monotonic()
        writers = [self.started(f"writer_{i}", chain.BIN / "lapis_test_echo", "--namespace", f"r{i}") for i in range(PAIRS)]
        readers = [self.start_probe(f"reader_{i}") for i in range(PAIRS)]
        for reader in readers:
            self.assert_found(reader, PAIRS, began + ALL_FOUND_WITHIN_S)
        found_s = time.monotonic() - began
        before = [cpu_s(process) for process in writers + readers]
        begin, began = len(readers[0].lines()), time.monotonic()
        self.assertTrue(readers[0].wait_for(lambda lines: len(lines) >= begin + IDLE_S * PAIRS))
        elapsed_s = time.monotonic() - began
        idle = [100 * (cpu_s(process) - was) / elapsed_s for process, was in zip(writers + readers, before)]
        print(f"figure: {2 * PAIRS} processes have found each other after {found_s:.1f} s; idle they take up to "
              f"{max(idle):.1f} % of a core")
        self.assertLessEqual(max(idle), IDLE_CPU_PERCENT)
        for process in writers + readers:
            process.send(signal.SIGTERM)
        for process in writers + readers:
            self.assertEqual(process.wait(20), 0, process.output())

    def test_processes_that_come_and_go_cost_no_sample(self):
        frames = len((chain.recording() / "associations.txt").read_text(encoding="utf-8").splitlines())
        probe = self.start_probe("probe")
        self.assertTrue(probe.wait_for_text("stamp_probe: ready"), probe.output())
        slam = chain.start("slam", self.folder / "slam.log")  # the replay waits for somebody who reads its images
        self.addCleanup(slam.kill)
        replay = chain.start("sensor_replay", self.folder / "replay.log", chain.recording(), "--rate", "2",
                             "--set", "sensor_replay.wait_for_readers=1")
        self.addCleanup(replay.kill)
        joined, next_s = 0, time.monotonic()
        end_s = next_s + PLAYED_WITHIN_S
        while replay.is_alive() and next_s < end_s:
            newcomer = self.start_probe("newcomer")
            newcomer.wait_for_text("stamp_probe: ready")
            newcomer.kill()
            joined += 1
            next_s = max(next_s + 1 / JOINS_PER_S, time.monotonic())
            replay.wait_for(lambda _: not replay.is_alive(), next_s - time.monotonic())
        self.assertEqual(replay.wait(0), 0, replay.output())

        def stamps(lines):
            found = {line.split()[1] for line in lines if line.startswith("camera ")}
            return found if len(found) >= frames else None
        self.assertTrue(probe.wait_for(stamps, 5), f"samples are missing of {frames}\n" + probe.output())
        print(f"figure: {joined} processes were started and killed, {frames} of {frames} samples have arrived")


if __name__ == "__main__":
    chain.main()
