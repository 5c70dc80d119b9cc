#!/usr/bin/env python3
"""Sends packets to a process that are known to harm Fast DDS 2.9.1, a new process for each, and says what became of it.

    lapis_in_private_domain tests/fuzz/rtps_known.py [--echo PROGRAM] [--only WORD] [--together]

--together sends all of them to one process, which is quicker.

Layout: OMG RTPS 2.3, section 9.4. What each does, and why: docs/decisions/0056-packet-guard.md.
"""
import argparse
import struct
import sys
import tempfile
import time

import rtps_session
from rtps_session import ECHO_MARK, PARTNER_MARK

DATA, DATA_FRAG, HEARTBEAT, GAP, INFO_TS = 0x15, 0x16, 0x07, 0x08, 0x09
INLINE_QOS, PAYLOAD, KEY_OF_FRAGMENTS = 2, 4, 4
FUTURE = 100_000  # a sequence number that the partner does not reach
METATRAFFIC, USER = 0, 1  # the echo's ports, in this order


def submessage(kind, body, flags=0):
    return struct.pack("<BBH", kind, flags | 1, len(body)) + body


def sequence(number):
    return struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)


class Streams:
    """The entity ids of the partner's images: the echo's reader and the partner's writer."""

    def __init__(self, templates):
        bodies = [message[at + 4:end] for _, message in templates for at, kind, end in rtps_session.submessages(message)
                  if kind == DATA_FRAG]
        self.writer = bodies[0][8:12]
        readers = {message[at + 4:at + 8] for _, message in templates
                   for at, kind, _ in rtps_session.submessages(message)
                   if kind == HEARTBEAT and message[at + 8:at + 12] == self.writer}
        self.entities = next((reader for reader in readers if any(reader)), bytes(4)) + self.writer

    @staticmethod
    def message(*parts):
        start = b"RTPS\x02\x03\x01\x0f" + PARTNER_MARK
        # Older samples than the newest one would be dropped.
        now = submessage(INFO_TS, struct.pack("<II", int(time.time()) + 1, 0))
        return start + submessage(rtps_session.INFO_DST, ECHO_MARK) + now + b"".join(parts)

    def heartbeat(self, first, last):
        return submessage(HEARTBEAT, self.entities + sequence(first) + sequence(last) + struct.pack("<I", 1 << 30))

    def gap(self, start, base):
        return submessage(GAP, self.entities + sequence(start) + sequence(base) + struct.pack("<I", 0))

    def data(self, number, octets_to_inline_qos=16, flags=PAYLOAD, rest=bytes(8)):
        return submessage(DATA, struct.pack("<HH", 0, octets_to_inline_qos) + self.entities + sequence(number) + rest,
                          flags)

    def fragments(self, number, first=1, count=1, size=60_000, sample=150_000, payload=None, flags=0):
        payload = bytes(min(count * size, sample - (first - 1) * size, 60_000)) if payload is None else payload
        fields = struct.pack("<IHHI", first, count, size, sample)
        body = struct.pack("<HH", 0, 28) + self.entities + sequence(number) + fields + payload
        return submessage(DATA_FRAG, body, flags)


def known(streams):
    """Name and packets."""
    message = streams.message
    statistics = submessage(0x80, bytes(56))
    yield "statistics twice", [message(statistics, statistics)]
    yield "heartbeat from 2^40", [message(streams.heartbeat(1 << 40, 1 << 40))]
    yield "heartbeat from 2^29", [message(streams.heartbeat(1 << 29, 1 << 29))]
    yield "gap from 1 to 2^40", [message(streams.gap(1, 1 << 40))]
    yield "gap of 2^22 in the future", [message(streams.gap(FUTURE, FUTURE + (1 << 22)))]
    yield "gap of 2^40 in the future", [message(streams.gap(FUTURE, FUTURE + (1 << 40)))]
    yield "data 2^62", [message(streams.data((1 << 62) + 7))]
    yield "data: QoS past its submessage", [message(streams.data(FUTURE, 40, rest=bytes(4)), streams.data(FUTURE + 1))]
    longer = struct.pack("<HH", 0x70, 24)  # a parameter that ends in the next submessage
    yield "data: parameter past its submessage", [
        message(streams.data(FUTURE, flags=INLINE_QOS | PAYLOAD, rest=longer),
                submessage(0x80, bytes(20) + struct.pack("<HH", 1, 0) + bytes(20)))]
    yield "all fragments in one of few bytes", [
        message(streams.fragments(FUTURE, count=1667, sample=100_000_000, payload=bytes(64)))]
    yield "last fragment beyond its bytes", [
        message(streams.fragments(FUTURE, count=3, payload=bytes(16))), ]
    yield "fragments of one byte", [message(streams.fragments(FUTURE, first=900, size=1, sample=1000))] * 3
    yield "fragments of no bytes", [message(streams.fragments(FUTURE, size=0, payload=bytes(8)))]
    yield "sample of 4 GB", [message(streams.fragments(FUTURE, size=4, sample=0xFFFFFFF0, payload=bytes(4)))]
    yield "fragmented key", [message(streams.fragments(FUTURE)),
                             message(streams.fragments(FUTURE, first=3, payload=b"", flags=KEY_OF_FRAGMENTS))]
    some = [message(streams.fragments(FUTURE, first=first)) for first in (1, 2, 3)]
    whole = message(streams.data(FUTURE, rest=bytes(5000)))
    yield "data within fragments", [some[0], whole, *some[1:], message(streams.gap(FUTURE, FUTURE + 1))]
    yield "data, fragments, a gap", [some[0], whole, message(streams.gap(FUTURE, FUTURE + 1)), *some[1:]]
    yield "data within fragments, twice", [some[0], whole, some[0], whole, *some[1:], *some]
    yield "sample that grows", [some[0], message(streams.fragments(FUTURE, first=2, sample=900_000)), *some[1:]]
    yield "sample that shrinks", [
        message(streams.fragments(FUTURE, sample=60_000_000)),
        message(streams.fragments(FUTURE, count=1000, size=4, sample=4000, payload=bytes(4000)))]


def trial(echo, folder, names):
    """What the packets of these names do to a new process."""
    session = rtps_session.Session(folder, echo)
    if not session.is_answering(20.0):
        raise RuntimeError("no answer before any packet: " + session.echo.text())
    streams = Streams(session.record(400))
    packets = dict(known(streams))
    for name in names:
        for packet in packets[name]:
            session.send(USER, packet)
    answers = session.answers_a_new_partner(6.0)
    early = session.echo.child.poll()
    text = session.echo.text()
    status = session.close()
    if early is not None:
        asserted = [line.split("Assertion")[-1].strip() for line in text.splitlines() if "Assertion" in line]
        return f"ended with status {early} " + " ".join(asserted)
    if not answers:
        return "does not answer" + (", deaf to SIGTERM" if status is None else f", ended with status {status}")
    return None if status == 0 else "deaf to SIGTERM" if status is None else f"ended with status {status}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--echo", default=rtps_session.BIN / "lapis_test_echo")
    parser.add_argument("--only", default="")
    parser.add_argument("--together", action="store_true")
    options = parser.parse_args()
    empty = Streams([(0, bytes(20) + submessage(DATA_FRAG, bytes(12)))])
    names = [name for name, _ in known(empty) if options.only in name]
    harmed = 0
    for group in [names] if options.together else [[name] for name in names]:
        with tempfile.TemporaryDirectory() as folder:
            harm = trial(options.echo, folder, group)
        harmed += harm is not None
        print(f"{'all' if len(group) > 1 else group[0]:36} {harm or 'answers'}", flush=True)
    return 1 if harmed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PermissionError as error:
        print("SKIPPED: what is sent cannot be recorded here:", error)
        sys.exit(77)
