#!/usr/bin/env python3
"""A recording with damaged images goes through the chain to its end: each flaw is named and counted, and what comes out
is finite."""
import math
import struct
import zlib
from pathlib import Path

import chain

FRAMES = 30
SIZE = (640, 360)  # of the recording's images
OTHER_SIZE = (640, 480)
CLASS_ABOVE_THE_LIST = 200


def png(value, bits, size=SIZE):
    """An image with the same value in each pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    width, height = size
    row = b"\0" + value.to_bytes(bits // 8, "big") * width
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(row * height)) + chunk(b"IEND", b""))


class Copy:
    """Links to the first frames of the recording; what is replaced is replaced here only."""

    def __init__(self, source, folder):
        self.source, self.folder = source, folder
        for part in ("rgb", "depth", "label"):
            (folder / part).mkdir(parents=True)
        for name in ("camera.yaml", "groundtruth.txt"):
            (folder / name).symlink_to(source / name)
        lines = (source / "associations.txt").read_text().splitlines()[:FRAMES]
        (folder / "associations.txt").write_text("\n".join(lines) + "\n")
        self.names = [Path(line.split()[1]).name for line in lines]
        for name in self.names:
            for part in ("rgb", "depth", "label"):
                (folder / part / name).symlink_to(source / part / name)

    def image(self, part, frame):
        return f"{part}/{self.names[frame]}"

    def replace(self, part, frame, content):
        """New bytes; None: no file."""
        path = self.folder / self.image(part, frame)
        path.unlink()
        if content is not None:
            path.write_bytes(content)

    def truncate(self, part, frame):
        content = (self.folder / self.image(part, frame)).read_bytes()
        self.replace(part, frame, content[:len(content) // 2])


def numbers_of(text):
    """All numbers of a text file, comment lines left out; "nan" and "inf" are numbers."""
    for line in text.splitlines():
        for word in line.replace(",", " ").split():
            try:
                yield line, float(word) if not line.startswith("#") else 0.0
            except ValueError:
                pass


def floats_of_ply(content):
    """Position and probability of each point."""
    header, body = content.split(b"end_header\n", 1)
    count = int(next(line.split()[2] for line in header.decode().splitlines() if line.startswith("element vertex")))
    points = list(struct.iter_unpack("<fff3BHf", body))
    assert len(points) == count
    return [value for x, y, z, *_, probability in points for value in (x, y, z, probability)]


class BadDataSetTest(chain.ChainTest):
    def make_data_set(self):
        data = Copy(chain.recording(), self.folder / "damaged")
        data.truncate("depth", 4)
        data.replace("depth", 7, None)
        data.replace("depth", 10, png(1500, 16, OTHER_SIZE))
        data.replace("rgb", 13, png(128, 8, OTHER_SIZE))
        data.replace("depth", 16, png(0, 16))
        data.replace("depth", 19, png(65535, 16))
        data.replace("label", 22, png(CLASS_ABOVE_THE_LIST, 8))
        data.truncate("rgb", 25)
        data.truncate("label", 28)
        return data

    def assert_logged(self, name, *texts):
        log = (self.folder / "run/logs" / f"{name}.log").read_text()
        for text in texts:
            self.assertIn(text, log)

    def assert_finite(self, folder):
        for file in ("trajectory_estimate.txt", "trajectory_ground_truth.txt", "keyframes.txt", "pose_graph.g2o",
                     "timeline.csv"):
            text = (folder / file).read_text()
            bad = [line for line, number in numbers_of(text) if not math.isfinite(number)]
            self.assertEqual(bad, [], file)
            self.assertNotEqual(text, "", file)
        metrics = (folder / "metrics.json").read_text()
        self.assertNotIn("NaN", metrics)
        self.assertNotIn("Infinity", metrics)
        self.assertTrue(all(map(math.isfinite, floats_of_ply((folder / "map.ply").read_bytes()))))
        self.assertTrue(chain.is_map_whole(folder / "map.lapis"))

    def test_damaged_images(self):
        data = self.make_data_set()
        run = self.play(data.folder, "run", "--labels", chain.recording() / "classes.csv")
        for part, frame, problem, counted in (
                ("depth", 4, "truncated or not an image", "depth images unusable"),
                ("depth", 7, "file missing", "depth images unusable"),
                ("depth", 10, "wrong size", "depth images unusable"),
                ("rgb", 13, "wrong size", "frames skipped"),
                ("rgb", 25, "truncated or not an image", "frames skipped"),
                ("label", 28, "truncated or not an image", "label images unusable")):
            self.assert_logged("sensor_replay", f"{data.image(part, frame)}: {problem}", f"{counted}: {problem}: 1")
        self.assert_logged("sensor_replay", "frame 30 of 30")
        self.assert_logged("slam", "frames dropped: no depth image for a colour image: 3")
        self.assert_logged("semantic_mapper", "pixels unlabelled: label not in the list: ")
        metrics = chain.metrics_of(run)
        print({key: metrics[key] for key in ("exit_reason", "frames_total", "frames_tracked", "lost_time_s",
                                             "ate_se3_rmse_m", "map_error_mean_m", "iou_top8_mean")})
        self.assertEqual(metrics["frames_total"], FRAMES - 2)  # the camera's: two have no colour image
        self.assertGreaterEqual(metrics["frames_tracked"], FRAMES - 2 - 3 - 2)  # no depth; nothing but 0 or 65535
        self.assertLessEqual(metrics["frames_tracked"], FRAMES - 2 - 3)
        self.assertEqual(metrics["exit_reason"], "completed")
        self.assertLessEqual(metrics["ate_se3_rmse_m"], 0.02)
        self.assert_finite(run)


if __name__ == "__main__":
    chain.main()
