#!/usr/bin/env python3
"""In lock-step the same recording gives the same bytes, whatever the size of the socket buffers."""
import re

import chain

SMALL_BUFFERS = "dds.socket_buffer_bytes=212992"  # what Linux grants without sysctl
LONGEST_TICK_S = 0.5


class DeterminismTest(chain.ChainTest):
    def longest_tick_s(self, folder):
        log = (folder / "logs/sensor_replay.log").read_text()
        found = re.search(r"longest tick ([0-9.]+) s", log)
        self.assertIsNotNone(found, log)
        return float(found.group(1))

    # The folders have the same last name, because a figure has it in its title.
    def test_same_input_same_bytes(self):
        first = self.play(chain.REDWOOD, "first/run")
        second = self.play(chain.REDWOOD, "second/run")
        small = self.play(chain.REDWOOD, "small_buffers/run", "--set", SMALL_BUFFERS)
        self.assert_same_run(first, second)
        self.assert_same_run(first, small)
        self.assertIn("socket buffers 212992 bytes", (small / "logs/slam.log").read_text())
        print("longest tick [s]:", *(f"{run.parent.name} {self.longest_tick_s(run)}" for run in (first, second, small)))
        self.assertLessEqual(self.longest_tick_s(small), LONGEST_TICK_S)

    def test_same_labels_same_bytes(self):
        options = ("--labels", chain.AWS_CLASSES, "--duration", "3")
        first, second = (self.play(chain.AWS, name, *options) for name in ("first/run", "second/run"))
        self.assert_same_run(first, second, chain.FILES + chain.FILES_OF_LABELS)


if __name__ == "__main__":
    chain.main()
