"""An echo process and its partner in the private domain of this process, and what one sends to the other.

Packets are kept as templates: the ids of the two participants, which each start draws anew, are replaced by marks, and
ports by their number among those of the echo. So a packet of one session can be sent in another one.
"""
import atexit
import collections
import os
import select
import socket
import struct
import subprocess
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("LAPIS_BIN", REPOSITORY / "build/release/bin"))
HEADER_BYTES = 20
PREFIX_BYTES = 12
ECHO_MARK, PARTNER_MARK = b"<echo prefix", b"<the partner"
INFO_DST = 0x0E
PACKET_OUTGOING = 4  # what is sent over the loopback interface is seen twice


class Process:
    """A child with its standard output; both streams are kept in a file."""

    def __init__(self, *command, log):
        self.log = Path(log)
        with open(log, "wb") as file:
            self.child = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL, stdout=file,
                                          stderr=subprocess.STDOUT)
        atexit.register(self.child.kill)  # whatever ends the script; nothing when it has been waited for

    def text(self):
        return self.log.read_text(errors="replace")

    def wait_for(self, text, deadline_s):
        end = time.monotonic() + deadline_s
        while text not in self.text():
            if time.monotonic() > end or self.child.poll() is not None:
                return text in self.text()
            time.sleep(0.02)
        return True

    def ends(self, deadline_s):
        """The exit status after SIGTERM; None when the process is deaf to it and had to be killed."""
        self.child.terminate()
        try:
            return self.child.wait(deadline_s)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
            return None

    def udp_ports(self):
        """Its RTPS ports, in ascending order: those of the domain, not the one it sends from."""
        inodes = set()
        for link in Path(f"/proc/{self.child.pid}/fd").iterdir():
            try:
                inodes.add(os.readlink(link))
            except OSError:
                continue
        first = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"])
        ports = set()
        for line in Path("/proc/net/udp").read_text().splitlines()[1:]:
            words = line.split()
            port = int(words[1].split(":")[1], 16)
            if f"socket:[{words[9]}]" in inodes and first <= port < first + 250:
                ports.add(port)
        return sorted(ports)


def submessages(message):
    """Offset, id and end of each submessage of an RTPS message."""
    at = HEADER_BYTES
    while at + 4 <= len(message):
        order = "<" if message[at + 1] & 1 else ">"
        length = struct.unpack_from(order + "H", message, at + 2)[0]
        end = min(at + 4 + length, len(message)) if length or message[at] in (0x01, 0x09) else len(message)
        yield at, message[at], end
        at = end


class Session:
    """An echo, a partner that it answers, and a socket for what is sent to the echo."""

    def __init__(self, folder, echo=BIN / "lapis_test_echo", image_bytes=150_000):
        self.folder = Path(folder)
        self.image_bytes = image_bytes
        self.partners = 0
        self.echo = Process(echo, log=self.folder / "echo.log")
        self.sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sender.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 22)
        self.partner = self._start_partner()
        self.ports = []
        self.prefixes = {}

    def _start_partner(self):
        self.partners += 1
        return Process(BIN / "lapis_test_packet_partner", self.image_bytes, 0.05,
                       log=self.folder / f"partner{self.partners}.log")

    def is_answering(self, deadline_s=10.0):
        return self.partner.wait_for("answer 3\n", deadline_s)

    def answers_a_new_partner(self, deadline_s=10.0):
        """A partner that nothing false has been said of."""
        self.partner.ends(5.0)
        self.partner = self._start_partner()
        if self.echo.child.poll() is not None or not self.is_answering(deadline_s):
            return False
        self.record(100)
        return True

    def record(self, count, deadline_s=20.0):
        """Templates of what the partner sends to the echo: (number of the port, bytes). For an echo that answers."""
        self.ports = self.echo.udp_ports()
        with socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0800)) as sniffer:
            sniffer.bind(("lo", 0))
            seen = self._seen_by(sniffer, count, deadline_s)
        self._learn_prefixes(seen)
        return [(port, self._replace(message, self.prefixes)) for port, message in seen]

    def _seen_by(self, sniffer, count, deadline_s):
        seen, end = [], time.monotonic() + deadline_s
        while len(seen) < count and time.monotonic() < end:
            if not select.select([sniffer], [], [], 0.2)[0]:
                continue
            frame, address = sniffer.recvfrom(70_000)
            ip = frame[14:]
            if address[2] == PACKET_OUTGOING or len(ip) < 28 or ip[9] != socket.IPPROTO_UDP:
                continue
            port = struct.unpack_from("!H", ip, 22)[0]
            message = ip[28:]
            if port in self.ports and message[:4] == b"RTPS":
                seen.append((self.ports.index(port), message))
        return seen

    def _learn_prefixes(self, seen):
        """The two that most of the addressed packets name."""
        pairs = collections.Counter((message[8:8 + PREFIX_BYTES], message[at + 4:at + 4 + PREFIX_BYTES])
                                    for _, message in seen for at, kind, _ in submessages(message) if kind == INFO_DST)
        if not pairs:
            raise RuntimeError("the partner never addressed the echo")
        partner, echo = pairs.most_common(1)[0][0]
        self.prefixes = {partner: PARTNER_MARK, echo: ECHO_MARK}

    @staticmethod
    def _replace(message, texts):
        for old, new in texts.items():
            message = message.replace(old, new)
        return message

    def send(self, port, template):
        message = self._replace(template, {mark: prefix for prefix, mark in self.prefixes.items()})
        try:
            self.sender.sendto(message[:65_507], ("127.0.0.1", self.ports[port % len(self.ports)]))
        except OSError:
            pass  # a full buffer: one packet less

    def close(self):
        """Ends both; the echo's exit status, None when it is deaf to SIGTERM."""
        self.partner.ends(5.0)
        status = self.echo.child.poll()
        status = self.echo.ends(5.0) if status is None else status
        self.sender.close()
        return status
