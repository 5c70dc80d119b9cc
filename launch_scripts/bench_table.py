#!/usr/bin/env python3
"""Prints one table of Google Benchmark results, with ratios to the peers that are in it; fails when one has failed.

usage: bench_table.py JSON_FILE...     as written by --benchmark_out
"""

import json
import pathlib
import re
import sys

import usage

PEERS = (  # names of kernels, and what they are measured against: the same job done the plain way
    (r"mutual_information/ray(\w*)/(.*)", r"mutual_information/plain_ray/\2"),
    (r"(?:dopt|whole)_candidate/(.*)", r"full_factorisation/\1"),
    (r"frontier_update/.*", "frontier_rescan"),
    (r"clearance_update/.*", "clearance_from_scratch"),
)
OWN_RATIO = {"ratio": "octomap_p50"}  # counters of a kernel that times its peer itself
NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}


def kernel_name(name):
    """Without Google Benchmark's remarks on how it was timed."""
    return re.sub(r"/(iterations:\d+|manual_time|process_time|real_time|min_time:[\d.]+)", "", name)


def read(file):
    """Results by kernel, in the order of the file."""
    results = json.loads(pathlib.Path(file).read_text())["benchmarks"]
    return {kernel_name(result["name"]): result for result in results if result["run_type"] == "iteration"}


def time_ns(result):
    """CPU time, which other processes disturb least, unless the kernel times itself."""
    key = "real_time" if "/manual_time" in result["name"] else "cpu_time"
    return result[key] * NANOSECONDS[result["time_unit"]]


def peer_of(name, kernels):
    for pattern, replacement in PEERS:
        match = re.fullmatch(pattern, name)
        if match and match.expand(replacement) in kernels:
            return match.expand(replacement)
    return None


def shown(nanoseconds):
    for unit in ("s", "ms", "us"):
        if nanoseconds >= NANOSECONDS[unit]:
            return f"{nanoseconds / NANOSECONDS[unit]:.3g} {unit}"
    return f"{nanoseconds:.3g} ns"


def times(ratio):
    return f"{ratio:.0f}" if ratio >= 100 else f"{ratio:.3g}"


def main():
    files = usage.arguments(__doc__, least=1)
    print("| benchmark | kernel | time | peer | ratio |")
    print("| --- | --- | --- | --- | --- |")
    has_failed = False
    for file in files:
        kernels = read(file)
        benchmark = pathlib.Path(file).stem.removeprefix("lapis_").removesuffix("_benchmark")
        for name, result in kernels.items():
            cells = ["-", "-"]
            if result.get("error_occurred"):
                has_failed = True
                print(f"| {benchmark} | {name} | {result['error_message']} | - | - |")
                continue
            peer = peer_of(name, kernels)
            own = next((counter for counter in OWN_RATIO if counter in result), None)
            if peer:
                cells = [f"{peer}: {shown(time_ns(kernels[peer]))}", times(time_ns(kernels[peer]) / time_ns(result))]
            elif own:
                cells = [f"{OWN_RATIO[own]}: {result[OWN_RATIO[own]]:.3g} ms", times(result[own])]
            print(f"| {benchmark} | {name} | {shown(time_ns(result))} | " + " | ".join(cells) + " |")
    return 1 if has_failed else 0


if __name__ == "__main__":
    sys.exit(main())
