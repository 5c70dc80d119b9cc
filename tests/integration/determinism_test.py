#!/usr/bin/env python3
"""In lock-step the same recording gives the same bytes, whatever the size of the socket buffers."""
import re

import chain

FILES = ("trajectory_estimate.txt", "keyframes.txt", "pose_graph.g2o", "map.lapis", "map.ot", "map.ply")
SMALL_BUFFERS = "dds.socket_buffer_bytes=212992"  # what Linux grants without sysctl
LONGEST_TICK_S = 0.5


class DeterminismTest(chain.ChainTest):
    def longest_tick_s(self, folder):
        log = (folder / "logs/sensor_replay.log").read_text()
        found = re.search(r"longest tick ([0-9.]+) s", log)
        self.assertIsNotNone(found, log)
        return float(found.group(1))

    def assert_same_files(self, one, other):
        for file in FILES:
            self.assertEqual((one / file).read_bytes(), (other / file).read_bytes(), f"{other / file} differs")

    def test_same_input_same_bytes(self):
        first = self.play(chain.REDWOOD, "first")
        second = self.play(chain.REDWOOD, "second")
        small = self.play(chain.REDWOOD, "small_buffers", "--set", SMALL_BUFFERS)
        self.assert_same_files(first, second)
        self.assert_same_files(first, small)
        self.assertIn("socket buffers 212992 bytes", (small / "logs/slam.log").read_text())
        print("longest tick [s]:", *(f"{run.name} {self.longest_tick_s(run)}" for run in (first, second, small)))
        self.assertLessEqual(self.longest_tick_s(small), LONGEST_TICK_S)


if __name__ == "__main__":
    chain.main()
