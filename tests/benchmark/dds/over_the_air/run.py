#!/usr/bin/env python3
"""Bytes per second of each topic between three machines: a free-running exploration of a flat (sensor and controller,
mapping, planning), whose packets are read on the router between them. Prints a table as Markdown.

Needs root (network namespaces, raw sockets). All packets of a topic count for it, headers, heartbeats, answers and repairs
included; a sample that goes to two processes goes over the air twice."""
import argparse
import collections
import ctypes
import json
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "integration"))
import chain  # pylint: disable=wrong-import-position
import machines  # pylint: disable=wrong-import-position

CLONE_NEWNET = 0x40000000
SO_RCVBUFFORCE = 33
PACKET_STATISTICS = (263, 6)
OUTGOING = 4
HEADERS = 14 + 20 + 8  # Ethernet, IP, UDP
RTPS_HEADER = 20
ACKNACK, HEARTBEAT, GAP, INFO_DST, NACK_FRAG, HEARTBEAT_FRAG, DATA, DATA_FRAG = 6, 7, 8, 0x0E, 0x12, 0x13, 0x15, 0x16
WRITER_AT = {HEARTBEAT: 8, GAP: 8, HEARTBEAT_FRAG: 8, DATA: 12, DATA_FRAG: 12}  # where a submessage has its writer's id
READER_SIDE = (ACKNACK, NACK_FRAG)
PUBLICATIONS = 0x000003C2  # the writer that announces writers
PID_TOPIC, PID_GUID, PID_END = 0x0005, 0x005A, 0x0001
HAS_INLINE_QOS, ENCAPSULATION = 2, 4
SCENE = chain.FURNISHED_FLAT.split("tour:", maxsplit=1)[0].replace("[4.12, 0, 5.6, 3]", "[4.12, 0, 10, 3]")


def parameters(submessage, at):
    """(id, value, where the next one begins) of a list of parameters, its end included."""
    while at + 4 <= len(submessage):
        pid, length = struct.unpack_from("<HH", submessage, at)
        yield pid, submessage[at + 4:at + 4 + length], at + 4 + length
        at += 4 + length
        if pid == PID_END:
            return


class Counter:
    """Counts datagrams by the link they come from and by what they are of."""

    def __init__(self):
        self.topics = {}  # by GUID of the writer
        self.bytes = collections.Counter()
        self.datagrams = collections.Counter()

    def add(self, link, frame):
        message = frame[HEADERS:]
        if len(frame) <= HEADERS or frame[23] != socket.IPPROTO_UDP or message[:4] != b"RTPS":
            key = (link, "other")
        else:
            key = (link, self.owner(message))
        self.bytes[key] += len(frame)
        self.datagrams[key] += 1

    def owner(self, message):
        """GUID of the writer that the message is of or for; "discovery" for those of Fast DDS itself."""
        source = destination = message[8:20]
        owner = None
        at = RTPS_HEADER
        while at + 4 <= len(message):
            kind, order = message[at], "<" if message[at + 1] & 1 else ">"
            length = struct.unpack_from(order + "H", message, at + 2)[0]
            end = at + 4 + length if length else len(message)
            if kind == INFO_DST:
                destination = message[at + 4:at + 16]
            elif kind in WRITER_AT or kind in READER_SIDE:
                writer = message[at + WRITER_AT.get(kind, 8):][:4]
                if kind == DATA and int.from_bytes(writer, "big") == PUBLICATIONS:
                    self.learn(message[at:end], order)
                is_of_topic = writer[3] & 0xC0 != 0xC0
                if is_of_topic and not owner:
                    owner = ((destination if kind in READER_SIDE else source) + writer).hex()
            at = end
        return owner or "discovery"

    def learn(self, submessage, order):
        """The topic of a writer, from its announcement: a list of parameters."""
        at = 8 + struct.unpack_from(order + "H", submessage, 6)[0]
        if submessage[1] & HAS_INLINE_QOS:
            at = max(end for _, _, end in parameters(submessage, at))
        found = {pid: value for pid, value, _ in parameters(submessage, at + ENCAPSULATION)}
        if PID_TOPIC in found and PID_GUID in found:
            length = struct.unpack_from("<I", found[PID_TOPIC])[0]
            self.topics[found[PID_GUID].hex()] = found[PID_TOPIC][4:3 + length].decode(errors="replace")

    def rows(self):
        """(link, topic, bytes, datagrams)."""
        sums = collections.defaultdict(lambda: [0, 0])
        for (link, owner), count in self.bytes.items():
            topic = self.topics.get(owner, owner if not owner.startswith("01") else "of writers that are not known")
            sums[link, topic][0] += count
            sums[link, topic][1] += self.datagrams[link, owner]
        return [(link, topic, *values) for (link, topic), values in sums.items()]


def open_sniffer(link):
    sniffer = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0800))
    sniffer.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 128 << 20)
    sniffer.bind((link, 0))
    sniffer.setblocking(False)
    return sniffer


def drain(sniffer, link, counter):
    try:
        for _ in range(1000):
            frame, address = sniffer.recvfrom(70_000)
            if address[2] != OUTGOING:
                counter.add(link, frame)
    except OSError:  # nothing more, or the link is down
        pass


def sniff(namespace):
    """Counts in a network namespace until the end of the standard input; SIGUSR1 begins anew. Prints JSON."""
    with open(namespace, encoding="utf-8") as file:
        if ctypes.CDLL(None, use_errno=True).setns(file.fileno(), CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), "setns")
    sniffers = {open_sniffer(name): name for name in machines.NAMES}
    counter, began = Counter(), [time.monotonic()]

    def begin_anew(*_):
        counter.bytes.clear()
        counter.datagrams.clear()
        began[0] = time.monotonic()
    signal.signal(signal.SIGUSR1, begin_anew)
    print("ready", flush=True)
    while True:
        readable, _, _ = select.select([*sniffers, sys.stdin], [], [])
        if sys.stdin in readable:
            break
        for sniffer in readable:
            drain(sniffer, sniffers[sniffer], counter)
    lost = sum(struct.unpack("II", sniffer.getsockopt(*PACKET_STATISTICS, 8))[1] for sniffer in sniffers)
    print(json.dumps({"seconds": time.monotonic() - began[0], "lost": lost, "rows": counter.rows()}))


def measure(arguments, folder):
    network = machines.network_or_skip()
    settings = network.discovery_server() if arguments.server else network.static_peers()
    options = [word for setting in arguments.set for word in ("--set", setting)]
    scene = folder / "flat.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    (folder / "run").mkdir()
    exploration = machines.Exploration(network, folder, scene, settings, options,
                                       "robot" if arguments.mapping_on_robot else "mapping")
    sniffer = subprocess.Popen([sys.executable, __file__, "--sniff", network.router.namespace], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    server = None
    try:
        sniffer.stdout.readline()
        server = network.start_server(folder / "server.log") if arguments.server else None
        exploration.start_all()
        if not exploration.processes["planner"].wait_for_text(" drives to ", 60):
            raise RuntimeError(exploration.processes["planner"].output())
        sniffer.send_signal(signal.SIGUSR1)
        before = network.bytes_carried()
        time.sleep(arguments.seconds)
        carried = {name: after[0] - before[name][0] for name, after in network.bytes_carried().items()}
        result = json.loads(sniffer.communicate("\n")[0])
        exploration.stop_all()
        return result, carried, lost_by_readers(exploration)
    finally:
        sniffer.kill()
        exploration.kill_all()
        if server:
            server.kill()
        network.close()


def lost_by_readers(exploration):
    return [f"{name}: {line.split(name + ': ', 1)[1]}" for name, process in exploration.processes.items()
            for line in process.lines() if "missed samples" in line or "left out" in line]


def print_table(result, carried, lost):
    seconds = result["seconds"]
    by_topic = collections.defaultdict(dict)
    for link, topic, count, datagrams in result["rows"]:
        name = topic[2:] if topic.startswith("rt/") else topic
        by_topic[name][link] = (count / seconds, datagrams / seconds)
    print("| topic | from robot [kB/s] | from mapping [kB/s] | from planning [kB/s] | datagrams/s |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for topic, links in sorted(by_topic.items(), key=lambda item: -sum(rate for rate, _ in item[1].values())):
        cells = [f"{links[name][0] / 1e3:.1f}" if name in links else "" for name in machines.NAMES]
        print(f"| `{topic}` | {' | '.join(cells)} | {sum(rate for _, rate in links.values()):.0f} |")
    sums = {name: sum(links[name][0] for links in by_topic.values() if name in links) for name in machines.NAMES}
    print(f"| all | {' | '.join(f'{sums[name] / 1e3:.0f}' for name in machines.NAMES)} | |")
    counted = ", ".join(f"{name} {carried[name] / seconds / 1e3:.0f}" for name in machines.NAMES)
    print(f"\n{seconds:.1f} s; counters of the router's links [kB/s]: {counted}; packets not seen: {result['lost']}")
    print("missed by readers:", "; ".join(lost) or "nothing")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="of an exploration, from its first goal on")
    parser.add_argument("--server", action="store_true", help="by a Discovery Server, not by static peers")
    parser.add_argument("--mapping-on-robot", action="store_true", help="slam and the mapper run there; else apart")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="of the robot's description")
    parser.add_argument("--sniff", metavar="NAMESPACE", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.sniff:
        sniff(arguments.sniff)
        return
    with tempfile.TemporaryDirectory(prefix="lapis_over_the_air_") as folder:
        os.environ.setdefault("ROS_DOMAIN_ID", "0")
        result, carried, lost = measure(arguments, Path(folder))
    print_table(result, carried, lost)


if __name__ == "__main__":
    main()
