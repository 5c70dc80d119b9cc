#!/usr/bin/env python3
"""A robot explores by processes on three machines: sensor and controller, mapping, planning (machines.py). The links of two
of them are cut for 10 s, one after the other: the robot stands and the run goes on, whether the machines find each other
by static peers or by a Discovery Server."""
import math
import re
import signal
import time

import chain
import machines

CUT_S = 10.0
TIMEOUT_S = 0.22  # controller.watchdog.*; after that the next command is zero
DELIVERY_S = 0.03
DRIVE_LAG_S = 1.0  # until a robot that is told to stand does so
STANDS_WITHIN_M = 0.01
DRIVES_AGAIN_S = 60.0  # slam may have to look all around for a place that it knows
DRIVES_BEFORE_M = 0.6
RATES_HZ = {"/odom": 50.0, "/clock": 15.0, "/camera/": 15.0, "/slam/": 15.0}
SMALL_CAMERA = ("--set", "robot.camera.width=320", "--set", "robot.camera.height=180")
SCENE = chain.FLAT.replace("[4.12, 0, 5.6, 3]", "[4.12, 0, 10, 3]")
# Who tells the robot what it must not move without, and what it is called by the probe.
SPEAKS_FOR = {"planning": "path", "mapping": "pose"}
# Topics of processes on the same machine, which no cut concerns.
ON_ONE_MACHINE = {"controller": ("/camera/depth/image_raw", "/camera/depth/camera_info"), "semantic_mapper": ("/slam/frame",)}


class Command:
    """A command that has arrived on the robot: time [s], and whether it is to move."""

    def __init__(self, words):
        self.time_s = float(words[1])
        self.moves = any(float(word) != 0.0 for word in words[3:])


class SeveralMachinesTest(chain.ChainTest):
    @classmethod
    def setUpClass(cls):
        cls.network = machines.network_or_skip()
        cls.addClassCleanup(cls.network.close)

    def explore(self, settings):
        (self.folder / "run").mkdir()
        scene = self.folder / "flat.yaml"
        scene.write_text(SCENE, encoding="utf-8")
        self.exploration = machines.Exploration(self.network, self.folder, scene, settings, SMALL_CAMERA)
        self.addCleanup(self.exploration.kill_all)
        self.probe = self.start_probe("robot", "stamp_probe")
        self.map_probe = self.start_probe("planning", "map_probe", self.folder / "run/map.lapis")
        self.exploration.start_all()
        self.wait_for_map(0)

    def start_probe(self, machine, name, *arguments):
        probe = self.exploration.start_program(machine, [chain.BIN / f"lapis_{name}", *arguments], name)
        self.assertTrue(probe.wait_for_text(f"{name}: ready"), probe.output())
        return probe

    def arrivals(self, lines, since_s):
        """Words of the probe's lines on what has come since then."""
        words = (line.split() for line in lines if line.startswith("arrived "))
        return [each for each in words if float(each[1]) >= since_s]

    def commands(self, lines, since_s):
        return [Command(words) for words in self.arrivals(lines, since_s) if words[2] == "command"]

    def wait_for_command(self, fits, since_s, seconds):
        """The first command since then that fits."""
        found = self.probe.wait_for(
            lambda lines: next((each for each in self.commands(lines[-200:], since_s) if fits(each)), None), seconds)
        self.assertIsNotNone(found, f"no such command within {seconds} s\n{self.logs()}")
        return found

    def places(self, lines):
        """Stamp [s], x and y [m] of the robot in truth."""
        return [tuple(map(float, line.split()[1:4])) for line in lines if line.startswith("truth ")]

    def wait_until_it_has_driven(self, metres):
        begin = len(self.probe.lines())

        def find(lines):
            places = self.places(lines[begin:])
            return sum(math.dist(a[1:], b[1:]) for a, b in zip(places[::15], places[15::15])) > metres
        self.assertTrue(self.probe.wait_for(find, DRIVES_AGAIN_S), f"it has not driven {metres} m\n{self.logs()}")

    def map_version(self):
        """Epoch and version of the newest map that the planner's machine has completed."""
        lines = [line.split() for line in self.map_probe.lines() if line.startswith("map ")]
        return (int(lines[-1][1]), int(lines[-1][2])) if lines else (0, 0)

    def wait_for_map(self, version):
        """Waits for a version after this one."""
        grown = self.map_probe.wait_for(lambda _: self.map_version()[1] > version, 20)
        self.assertTrue(grown, f"no map after version {version}\n{self.map_probe.output()}\n{self.logs()}")

    def logs(self):
        tails = {name: "\n".join(process.lines()[-8:]) for name, process in self.exploration.processes.items()
                 if not name.endswith("_probe")}
        return "\n".join(f"-- {name}\n{tail}" for name, tail in tails.items())

    def assert_alive(self):
        for process in self.exploration.processes.values():
            self.assertTrue(process.is_alive(), process.output())

    def cut_and_heal(self, name):
        """Cuts a machine off while the robot drives; returns when it drives again, with a map that grows."""
        self.wait_until_it_has_driven(DRIVES_BEFORE_M)
        self.wait_for_command(lambda command: command.moves, time.monotonic(), DRIVES_AGAIN_S)
        version = self.map_version()[1]
        self.network.cut(name)
        cut_s = time.monotonic()
        self.wait_for_command(lambda command: command.time_s > cut_s + CUT_S, cut_s, CUT_S + 10)
        self.assert_stood(name, cut_s)
        self.network.heal(name)
        healed_s = time.monotonic()
        what = SPEAKS_FOR[name]
        spoke = self.probe.wait_for(lambda lines: [each for each in self.arrivals(lines[-200:], healed_s)
                                                   if each[2] == what], 20)
        self.assertTrue(spoke, f"no {what} comes\n{self.logs()}")
        drives = self.wait_for_command(lambda command: command.moves, healed_s, DRIVES_AGAIN_S)
        print(f"{name}: healed; {what} after {float(spoke[0][1]) - healed_s:.2f} s, drives after "
              f"{drives.time_s - healed_s:.2f} s")
        self.assert_alive()
        self.wait_for_map(version)
        return cut_s, drives.time_s

    def assert_stood(self, name, cut_s):
        """The robot was told to stand in time, and stood until now."""
        lines = self.probe.lines()
        last_s = max(float(words[1]) for words in self.arrivals(lines, cut_s - 2.0) if words[2] == SPEAKS_FOR[name])
        commands = self.commands(lines, last_s - 0.1)
        moving_s = max((command.time_s for command in commands if command.moves), default=last_s)
        stop_s = min(command.time_s for command in commands if command.time_s > moving_s)
        times_s = [command.time_s for command in commands if command.time_s <= stop_s]
        gap_s = max(b - a for a, b in zip(times_s, times_s[1:]))  # 0.05 s, if the machine is not too busy
        print(f"{name}: cut; the command is zero {stop_s - last_s:.3f} s after the last {SPEAKS_FOR[name]}; commands up "
              f"to {gap_s:.3f} s apart")
        self.assertLess(last_s, cut_s + 0.5)
        self.assertLessEqual(stop_s - last_s, TIMEOUT_S + DELIVERY_S + gap_s, self.logs())
        self.assert_stands(lines, CUT_S - (stop_s - cut_s) - DRIVE_LAG_S)

    def assert_stands(self, lines, seconds):
        """The true position has not changed for so long."""
        places = self.places(lines)
        late = [place for place in places if place[0] > places[-1][0] - seconds]
        for axis in (1, 2):
            values = [place[axis] for place in late]
            self.assertLess(max(values) - min(values), STANDS_WITHIN_M, "the robot moved while it was cut off")

    def stop_all(self):
        """The run ends as any other, and who has followed the map has all of it."""
        self.assert_alive()
        for name, status in self.exploration.stop_all().items():
            self.assertEqual(status, 0, self.exploration.processes[name].output())
        self.map_probe.send(signal.SIGUSR1)
        self.assertEqual(self.map_probe.wait_for_text("saved map: "), "saved map: same", self.map_probe.output())

    def assert_nothing_lost_but_in_the_cuts(self, seconds):
        """Samples that a reader has missed (logged at its end): none of its own machine, and of others none but those
        that were sent while a link was cut and until both ends had found each other again."""
        lost = re.compile(r"missed samples rt(/\S+): (\d+)")
        for name, process in self.exploration.processes.items():
            for topic, text in lost.findall(process.output()):
                print(f"{name}: {topic}: {text} missed")
                self.assertNotIn(topic, ON_ONE_MACHINE.get(name, ()))
                for part, rate_hz in RATES_HZ.items():
                    if topic.startswith(part):
                        self.assertLessEqual(int(text), rate_hz * seconds, f"{topic} at {name}")
            self.assertNotIn("left out", process.output())

    def assert_one_run(self):
        """slam and the mapper have continued, and not begun anew."""
        sessions = {line.split()[2] for line in self.probe.lines() if line.startswith("slam ")}
        epochs = {line.split()[1] for line in self.map_probe.lines() if line.startswith("map ")}
        self.assertEqual((len(sessions), len(epochs)), (1, 1))

    def check(self, settings):
        self.explore(settings)
        seconds = 0.0
        for name in SPEAKS_FOR:
            cut_s, drives_s = self.cut_and_heal(name)
            seconds += drives_s - cut_s
        self.stop_all()
        self.assert_one_run()
        self.assert_nothing_lost_but_in_the_cuts(seconds)


class StaticPeersTest(SeveralMachinesTest):
    def test_links_are_cut_and_healed(self):
        self.check(self.network.static_peers())

    def test_who_starts_without_a_network_says_that_nobody_will_find_it(self):
        exploration = machines.Exploration(self.network, self.folder, None, self.network.static_peers())
        self.addCleanup(exploration.kill_all)
        for is_cut in (True, False):
            (self.network.cut if is_cut else self.network.heal)("planning")
            self.network.wait_until_it_sees("planning", not is_cut)
            planner = exploration.start("planning", "planner")
            self.assertEqual("no network interface is up" in planner.output(), is_cut, planner.output())
            self.assertEqual(planner.stop(), 0, planner.output())
            planner.kill()  # closes its output


class DiscoveryServerTest(SeveralMachinesTest):
    @classmethod
    def setUpClass(cls):
        machines.server_or_skip()
        super().setUpClass()

    def test_links_are_cut_and_healed(self):
        server = self.network.start_server(self.folder / "server.log")
        self.addCleanup(server.kill)
        self.check(self.network.discovery_server())
        self.assertTrue(server.is_alive(), server.output())


if __name__ == "__main__":
    chain.main()
