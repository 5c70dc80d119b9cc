#!/usr/bin/env python3
"""How long an image takes from one process of a host to another, and what that costs: by UDP and by shared memory.

usage: run.py [--rounds N] [--seconds S] [--hz RATE]

Both transports send images of 640 x 360 and of 1280 x 720 pixels (rgb8) in turns. Prints the medians of the rounds as a
table in Markdown: share of the images that arrived, their age on arrival, time in write(), and CPU time of both sides.
Start it in a domain of its own, on this host only:

    ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST build/release/bin/lapis_in_private_domain tests/benchmark/dds/image_hop/run.py
"""
import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
BIN = Path(os.environ.get("LAPIS_BIN", ROOT / "build/release/bin"))
TRANSPORTS = {"UDP": [], "shared memory": ["--shm"]}
SIZES = {"640 x 360": 691_200, "1280 x 720": 2_764_800}
FIGURES = {"images [%]": 1, "age p50 [ms]": 2, "age p95 [ms]": 2, "write p50 [ms]": 2, "write p99 [ms]": 2,
           "CPU of the writer [ms/image]": 2, "CPU of the reader [ms/image]": 2}  # and their decimals


def measure(transport, size, options):
    """Figures of one round, in the order of FIGURES."""
    program = [BIN / "lapis_lossy_link"]
    with subprocess.Popen([*program, "subscribe", *TRANSPORTS[transport]], stdout=subprocess.PIPE, text=True) as reader:
        images = round(options.seconds * options.hz)
        sent = json.loads(subprocess.run([*program, "publish", "--tiles", "0", "--images", str(images), "--images-hz",
                                          str(options.hz), "--image-bytes", str(SIZES[size]), *TRANSPORTS[transport]],
                                         stdout=subprocess.PIPE, text=True, check=True,
                                         timeout=options.seconds + 60).stdout)
        reader.send_signal(signal.SIGTERM)
        received = json.loads(reader.stdout.read())
    return (100 * received["images"] / sent["images"], 1e3 * received["age_p50_s"], 1e3 * received["age_p95_s"],
            sent["write_p50_ms"], sent["write_p99_ms"], 1e3 * sent["cpu_s"] / images, 1e3 * received["cpu_s"] / images)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n", maxsplit=1)[0], description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=10.0, help="of images in a round")
    parser.add_argument("--hz", type=float, default=30.0)
    options = parser.parse_args()
    if not (BIN / "lapis_lossy_link").is_file():
        parser.error(f"{BIN}/lapis_lossy_link is missing; build it: cmake --build --preset release --target lossy_link")
    rounds = {(transport, size): [] for size in SIZES for transport in TRANSPORTS}
    for number in range(options.rounds):
        for transport, size in rounds:
            print(f"round {number + 1} of {options.rounds}: {transport}, {size}", file=sys.stderr)
            rounds[transport, size].append(measure(transport, size, options))
    print("| transport | image | " + " | ".join(FIGURES) + " |\n|" + " --- |" * (len(FIGURES) + 2))
    for (transport, size), rows in rounds.items():
        medians = [f"{statistics.median(values):.{decimals}f}" for values, decimals in zip(zip(*rows), FIGURES.values())]
        print(f"| {transport} | {size} | " + " | ".join(medians) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
