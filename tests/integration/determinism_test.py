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
        labels = ("--labels", chain.recording() / "classes.csv")
        first, second = (self.play(chain.recording(), name, *labels) for name in ("first/run", "second/run"))
        small = self.play(chain.recording(), "small_buffers/run", *labels, "--set", SMALL_BUFFERS)
        for other in (second, small):
            self.assert_same_run(first, other, chain.FILES + chain.FILES_OF_LABELS)
        self.assertGreater(chain.metrics_of(first)["loop_closures"], 0, "poses that change after the fact are compared, too")
        self.assertIn("socket buffers 212992 bytes", (small / "logs/slam.log").read_text())
        print("figure: longest tick [s]:", *(f"{run.parent.name} {self.longest_tick_s(run)}" for run in (first, second, small)))
        self.assertLessEqual(self.longest_tick_s(small), LONGEST_TICK_S)


if __name__ == "__main__":
    chain.main()
