#!/usr/bin/env python3
"""Sends damaged RTPS packets to a process and watches that it lives, answers and ends when asked.

    lapis_in_private_domain tests/fuzz/rtps_fuzz.py [--packets 25000] [--seed 1] [--echo PROGRAM] [--find FILE]

The packets are those that a partner sends to the process, with some of their fields, bytes or lengths changed. Without
--find a fault ends the run with status 1. With it the packets since the last good answer are bisected, the mutations of
the last one left are undone one by one as far as the fault stays, and what remains is written to FILE.
"""
import argparse
import json
import random
import struct
import sys
import tempfile
import time
from pathlib import Path

import rtps_session

RECORDED = 1500
BETWEEN_CHECKS = 2500
BURST = 25  # packets without a pause; a socket buffer holds more
VALUES = (0, 1, 2, 3, 127, 128, 255, 256, 257, 65535, 65536, 1 << 24, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)


def mutation(message, rng):
    """A change to a packet, as (offset, number of bytes that go, bytes that come)."""
    parts = list(rtps_session.submessages(message))
    at, _, end = rng.choice(parts) if parts else (0, 0, len(message))
    end = min(end, at + 140)  # fields, not the payload of an image
    kind = rng.random()
    if kind < 0.45:  # a field of four bytes
        place = at + 4 * rng.randrange(1, max(2, (end - at) // 4))
        return place, 4, struct.pack(rng.choice("<>") + "I", rng.choice(VALUES))
    if kind < 0.55:  # a field of two bytes: lengths and counts
        place = at + 2 * rng.randrange(0, max(1, (end - at) // 2))
        return place, 2, struct.pack(rng.choice("<>") + "H", rng.choice(VALUES) & 0xFFFF)
    if kind < 0.75:  # one bit
        place = rng.randrange(at, max(at + 1, end))
        return place, 1, bytes([message[min(place, len(message) - 1)] ^ 1 << rng.randrange(8)])
    if kind < 0.82:  # the kind of submessage
        return at, 1, bytes([rng.choice((1, 6, 7, 8, 9, 12, 14, 18, 19, 21, 22, 128))])
    if kind < 0.88:  # cut off
        place = rng.randrange(rtps_session.HEADER_BYTES, len(message) + 1)
        return place, len(message) - place, b""
    if kind < 0.94:  # pushed apart
        return rng.randrange(at, max(at + 1, end)), 0, rng.randbytes(rng.randrange(1, 32))
    return len(message), 0, bytes(message[at:end])  # once more


def apply(message, mutations):
    for place, gone, come in mutations:
        message = message[:place] + come + message[place + gone:]
    return message


def damaged(templates, rng):
    """A packet: its port, the valid template and its mutations."""
    port, template = rng.choice(templates)
    message, mutations = template, []
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        mutations.append(mutation(message, rng))
        message = apply(message, mutations[-1:])
    return (port if rng.random() < 0.7 else rng.randrange(8)), template, mutations


class Run:
    """A session, and the packets since it last was as it should be."""

    def __init__(self, echo, folder, without=()):
        self.echo, self.folder, self.without = echo, folder, without
        self.session = None
        self.templates = []

    def start(self):
        self.session = rtps_session.Session(self.folder, self.echo)
        if not self.session.is_answering(20.0):
            raise RuntimeError("no answer before any packet: " + self.session.echo.text())
        self.templates = [(port, self._stripped(message)) for port, message in self.session.record(RECORDED)]

    def _stripped(self, message):
        parts = [message[at:end] for at, kind, end in rtps_session.submessages(message) if kind not in self.without]
        return b"".join([message[:rtps_session.HEADER_BYTES], *parts])

    def send(self, packets):
        for number, (port, template, mutations) in enumerate(packets):
            message = apply(template, mutations)
            if not any(kind in self.without for _, kind, _ in rtps_session.submessages(message)):
                self.session.send(port, message)
            if number % BURST == 0:
                time.sleep(0.002)

    def fault(self):
        """What is wrong with the process, or None."""
        if self.session.echo.child.poll() is not None:
            return f"ended with status {self.session.echo.child.returncode}"
        return None if self.session.answers_a_new_partner() else "does not answer"

    def ends_well(self):
        status = self.session.close()
        return None if status == 0 else "deaf to SIGTERM" if status is None else f"ended with status {status}"

    def fault_of(self, packets):
        """What these packets do to a new process."""
        self.start()
        self.send(packets)
        fault = self.fault()
        return fault or self.ends_well() if fault is None else (self.session.close(), fault)[1]


def bisect(run, packets):
    """One packet of these that alone does harm; None when only several together do."""
    while len(packets) > 1:
        half = len(packets) // 2
        for part in (packets[half:], packets[:half]):
            if run.fault_of(part):
                packets = part
                break
        else:
            return None
        print(f"  {len(packets)} packets left", flush=True)
    return packets[0]


def minimise(run, packet):
    port, template, mutations = packet
    for mutation_ in list(mutations):
        fewer = [other for other in mutations if other is not mutation_]
        if fewer and run.fault_of([(port, template, fewer)]):
            mutations = fewer
    return port, template, mutations


def find(run, packets, file):
    packet = bisect(run, packets)
    if packet is None:
        print("  no single packet of these does it alone")
        return
    port, template, mutations = minimise(run, packet)
    fault = run.fault_of([(port, template, mutations)])
    kinds = [f"0x{kind:02x}@{at}-{end}" for at, kind, end in rtps_session.submessages(template)]
    changes = [f"{place}: -{gone} +{come.hex()}" for place, gone, come in mutations]
    record = {"fault": fault, "port": port, "submessages": kinds, "changes": changes,
              "template": template[:400].hex(), "size": len(template), "text": run.session.echo.text()[-400:]}
    print(json.dumps(record, indent=1))
    Path(file).write_text(json.dumps(record))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--packets", type=int, default=25_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--echo", default=rtps_session.BIN / "lapis_test_echo")
    parser.add_argument("--find")
    parser.add_argument("--without", type=int, nargs="*", default=[], help="kinds of submessages that are not sent")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        run = Run(options.echo, folder, options.without)
        run.start()
        for first in range(0, options.packets, BETWEEN_CHECKS):
            packets = [damaged(run.templates, rng) for _ in range(min(BETWEEN_CHECKS, options.packets - first))]
            run.send(packets)
            fault = run.fault()
            if fault:
                print(f"seed {options.seed}, after {first + len(packets)} packets: the process {fault}", flush=True)
                print(run.session.echo.text()[-1500:])
                run.session.close()
                if options.find:
                    find(run, packets, options.find)
                return 1
        print(run.session.echo.text()[-2000:])
        fault = run.ends_well()
        print(f"seed {options.seed}: {options.packets} packets, then the process {fault or 'answered and ended well'}")
        return 1 if fault else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PermissionError as error:
        print("SKIPPED: what is sent cannot be recorded here:", error)
        sys.exit(77)
