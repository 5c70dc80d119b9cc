#!/usr/bin/env python3
"""Who is met in which discovery range, on a host that has an address beside that of the loopback interface.

Runs in a private domain (lapis_in_private_domain), whose network namespace is this host; a second one is another host.
The echo component answers the images of a participant that is set up as ROS 2 Jazzy sets one up, so an answer says that
discovery and data work in both directions. Exit status 77: no links between network namespaces here.
"""
import itertools
import os
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

BIN = Path(os.environ.get("LAPIS_BIN", Path(__file__).resolve().parents[3] / "build/release/bin"))
ECHO = os.environ.get("LAPIS_TEST_ECHO", BIN / "lapis_test_echo")
HERE, THERE = "10.99.0.1", "10.99.0.2"
ANSWER_S = 12.0
SILENCE_S = 4.0  # discovery takes a fraction of a second; announcements come once per second
IMAGE_BYTES, PERIOD_S = 691_200, 0.1
SKIPPED = 77
RANGES = ("LOCALHOST", "SUBNET")
KILL = bytes.fromhex("52545053 0203 010f") + bytes(range(12)) + 2 * (bytes.fromhex("8001 3800") + bytes(56))


def ip(*arguments, enter=()):
    subprocess.run([*enter, "ip", *arguments], check=True, capture_output=True)


class OtherHost:
    """A network namespace that is linked to this one."""

    def __init__(self):
        self.holder = subprocess.Popen(["unshare", "--net", "sleep", "infinity"])
        self.enter = ["nsenter", f"--net=/proc/{self.holder.pid}/ns/net"]

    def link(self):
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == own and self.holder.poll() is None:
            time.sleep(0.01)
        ip("link", "add", "here", "type", "veth", "peer", "name", "there", "netns", str(self.holder.pid))
        for enter, link, address in (([], "here", HERE), (self.enter, "there", THERE)):
            ip("link", "set", "lo", "up", enter=enter)
            ip("address", "add", address + "/24", "dev", link, enter=enter)
            ip("link", "set", link, "up", enter=enter)
            ip("route", "replace", "224.0.0.0/4", "dev", link, enter=enter)

    def send(self, message, addresses):
        """Datagrams from there, each to (address, port)."""
        script = ("import ast,socket,sys; s=socket.socket(socket.AF_INET,socket.SOCK_DGRAM)\n"
                  "for a in ast.literal_eval(sys.argv[2]): s.sendto(bytes.fromhex(sys.argv[1]),a)")
        subprocess.run([*self.enter, sys.executable, "-c", script, message.hex(), repr(addresses)], check=True)

    def close(self):
        self.holder.kill()
        self.holder.wait()


class Child:
    """A process and what it has said."""

    def __init__(self, command, folder, **variables):
        self.log = tempfile.NamedTemporaryFile(dir=folder)
        self.child = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL, stdout=self.log,
                                      stderr=subprocess.STDOUT, env={**os.environ, **variables})

    def text(self):
        return Path(self.log.name).read_text(errors="replace")

    def says(self, text, deadline_s):
        end = time.monotonic() + deadline_s
        while text not in self.text():
            if time.monotonic() > end or self.child.poll() is not None:
                return False
            time.sleep(0.02)
        return True

    def close(self):
        self.child.terminate()
        try:
            self.child.wait(5)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.log.close()


class LocalhostTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.other_host = None
        try:
            cls.other_host = OtherHost()
            cls.other_host.link()
        except (OSError, subprocess.CalledProcessError) as error:
            if cls.other_host:
                cls.other_host.close()
            print("SKIPPED: no link between network namespaces:", error)
            sys.exit(SKIPPED)
        cls.addClassCleanup(cls.other_host.close)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def start(self, command, **variables):
        child = Child(command, self.folder, **variables)
        self.addCleanup(child.close)
        return child

    def echo(self, **variables):
        echo = self.start([ECHO], **variables)
        self.assertTrue(echo.says("ready", 20), echo.text())
        return echo

    def jazzy(self, *arguments, there=False):
        enter = self.other_host.enter if there else []
        return self.start([*enter, BIN / "lapis_test_jazzy_like", *arguments])

    def test_ranges_meet_on_one_host(self):
        for own, of_jazzy in itertools.product(RANGES, RANGES):
            with self.subTest(lapis=own, jazzy=of_jazzy):
                echo = self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE=own)
                jazzy = self.jazzy(of_jazzy)
                self.assertTrue(jazzy.says("answer 30\n", ANSWER_S))  # with three of the echo's reports
                self.assertNotIn("dropped", echo.text())
                jazzy.close()
                echo.close()

    def test_large_images_pass_between_ranges_on_one_host(self):
        for own, of_partner in itertools.product(RANGES, RANGES):
            with self.subTest(echo=own, partner=of_partner):
                echo = self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE=own)
                partner = self.start([BIN / "lapis_test_packet_partner", str(IMAGE_BYTES), str(PERIOD_S)],
                                     ROS_AUTOMATIC_DISCOVERY_RANGE=of_partner)
                self.assertTrue(partner.says("answer 10\n", ANSWER_S), echo.text())
                partner.close()
                echo.close()

    def test_hosts_meet_on_the_subnet(self):
        self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET")
        self.assertTrue(self.jazzy("SUBNET", there=True).says("answer 5\n", ANSWER_S))

    def test_localhost_is_closed_to_other_hosts(self):
        self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")
        jazzy = self.jazzy("SUBNET", HERE, there=True)  # it knows where to look
        self.assertFalse(jazzy.says("answer", SILENCE_S))
        self.assertTrue(self.jazzy("LOCALHOST").says("answer", ANSWER_S))

    def test_only_allowed_peers_are_met(self):
        for allowed, is_met in ((THERE, True), ("10.99.0.0/24", True), ("10.99.0.3", False)):
            with self.subTest(allowed=allowed):
                echo = self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET", LAPIS_ALLOWED_PEERS=allowed)
                jazzy = self.jazzy("SUBNET", HERE, there=True)
                self.assertEqual(jazzy.says("answer", ANSWER_S if is_met else SILENCE_S), is_met)
                if not is_met:
                    self.assertTrue(echo.says(f"RTPS packets dropped (sender), the last of {THERE}", 5), echo.text())
                jazzy.close()
                echo.close()

    def test_a_static_peer_is_met_on_localhost(self):
        self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_STATIC_PEERS=THERE)
        self.assertTrue(self.jazzy("SUBNET", HERE, there=True).says("answer", ANSWER_S))

    def test_the_datagram_that_killed(self):
        first = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"])
        addresses = [(HERE, port) for port in range(first + 10, first + 30)] + [("239.255.0.1", first)]
        for own in RANGES:
            with self.subTest(lapis=own):
                echo = self.echo(ROS_AUTOMATIC_DISCOVERY_RANGE=own)
                self.other_host.send(KILL, addresses)
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own_host:
                    for port in range(first + 10, first + 30):
                        own_host.sendto(KILL, ("127.0.0.1", port))
                self.assertTrue(self.jazzy(own).says("answer", ANSWER_S))
                self.assertTrue(echo.says("RTPS packets dropped (statistics)", 5), echo.text())
                echo.close()


if __name__ == "__main__":
    unittest.main(verbosity=2)
