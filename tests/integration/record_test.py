#!/usr/bin/env python3
"""A run that is recorded as a bag, and the bag played again, in each storage: the same map and the same poses."""
import re
import subprocess

import chain

FILES = ("map.lapis", "keyframes.txt", "trajectory_estimate.txt", "pose_graph.g2o", "slam.lapis")


class RecordTest(chain.ChainTest):
    def assert_same_bytes(self, one, other):
        differing = [file for file in FILES if (one / file).read_bytes() != (other / file).read_bytes()]
        self.assertEqual(differing, [], f"{one} and {other} differ")

    def counts(self, bag):
        """Messages by topic, as sensor_replay lists them."""
        listed = subprocess.run([chain.BIN / "lapis_sensor_replay", bag, "--list"], check=True, capture_output=True, text=True)
        return {topic: int(number) for topic, number in re.findall(r"^ +(/\S+) +\S+ +(\d+) messages$", listed.stdout, re.M)}

    def record(self, storage):
        bag = self.folder / storage
        run = self.play(chain.recording(), f"{storage}_run", "--record", bag, "--set", f"recorder.storage={storage}")
        counts = self.counts(bag)
        frames = counts["/camera/color/image_raw"]
        self.assertEqual(frames, len((chain.recording() / "rgb.txt").read_text().splitlines()) -
                         sum(line.startswith("#") for line in (chain.recording() / "rgb.txt").read_text().splitlines()))
        for topic in ("/camera/depth/image_raw", "/camera/semantic/image_raw", "/camera/depth/camera_info", "/slam/frame", "/clock"):
            self.assertEqual(counts[topic], frames, topic)
        self.assertEqual(counts["/camera/semantic/label_info"], 1)
        return bag, run

    def test_a_bag_gives_the_map_of_the_run(self):
        for storage in ("mcap", "sqlite3"):
            bag, run = self.record(storage)
            self.assert_same_bytes(run, self.play(bag, f"{storage}_again"))
        self.assert_same_bytes(run, self.play(self.folder / "mcap/mcap_0.mcap", "file_again"))


if __name__ == "__main__":
    chain.main()
