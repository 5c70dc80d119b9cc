#!/usr/bin/env python3
"""--transport shm: what killed processes leave in shared memory is removed, and where there is no room, UDP is used."""
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import chain

MEMORY = Path("/dev/shm")
SEGMENT = re.compile(r"fastrtps_[0-9a-f]{16}")
KILLS = int(os.environ.get("LAPIS_KILLS", "10"))


class SharedMemoryTest(chain.ChainTest):
    """Runs in a mount namespace of its own, so that /dev/shm is the test's."""

    def mount(self, megabytes):
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", MEMORY], check=True)
        self.addCleanup(subprocess.run, ["umount", MEMORY], check=True)

    def start(self, number=0):
        process = chain.start("slam", self.folder / f"{number}.log", "--transport", "shm")
        self.addCleanup(process.kill)
        return process

    def segments(self):
        return [file.name for file in MEMORY.iterdir() if SEGMENT.fullmatch(file.name)]

    def test_what_killed_processes_left_is_removed_at_the_next_start(self):
        self.mount(100)
        for number in range(KILLS):
            process = self.start(number)
            self.assertEqual(len(self.segments()), 1, self.segments())
            process.send(signal.SIGKILL)
            self.assertEqual(process.wait(), -signal.SIGKILL)
        process = self.start(KILLS)
        self.assertEqual(process.stop(), 0, process.output())
        self.assertEqual(self.segments(), [])

    def test_without_room_udp_is_used_and_the_reason_given(self):
        self.mount(8)
        process = self.start()
        self.assertTrue(any("/dev/shm has 8 MB left, and a participant needs 17 MB; UDP is used instead" in line
                            for line in process.lines()), process.output())
        self.assertEqual(self.segments(), [])
        self.assertEqual(process.stop(), 0, process.output())

    def test_the_last_room_is_not_given_to_two(self):
        self.mount(24)
        processes = [self.start(number) for number in range(3)]
        without = [process for process in processes if any("UDP is used" in line for line in process.lines())]
        self.assertEqual(len(without), 2, [process.output() for process in processes])
        for process in processes:
            self.assertEqual(process.stop(), 0, process.output())


if __name__ == "__main__":
    if "LAPIS_OWN_MEMORY" not in os.environ:
        os.environ["LAPIS_OWN_MEMORY"] = "1"
        user = ["--user", "--map-root-user"] if os.geteuid() else []
        os.execvp("unshare", ["unshare", *user, "--mount", sys.executable, *sys.argv])
    chain.main()
