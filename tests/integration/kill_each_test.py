#!/usr/bin/env python3
"""Each process is killed in turn while a recording plays in real time: the others continue, and the restarted one soon
publishes what it computed from inputs that are newer than its restart."""
import time

import chain

ANSWER_S = 3.0  # from the ready line to the first output of new input
ENDED_WITHIN_S = 60.0  # the evaluator draws figures
WARM_UP_FRAMES = 40  # before the kill


class Sample:
    """A line of the probe: topic, stamp, detail."""

    def __init__(self, line):
        words = line.split()
        self.topic, self.stamp, self.detail = words[0], float(words[1]), words[2:]


def samples(lines, topic):
    return [Sample(line) for line in lines if line.startswith(f"{topic} ")]


class KillEachTest(chain.ChainTest):
    def setUp(self):
        super().setUp()
        self.processes = {}
        self.probe = chain.Process([chain.BIN / "lapis_stamp_probe"], self.folder / "probe.log")
        self.addCleanup(self.probe.kill)
        self.assertTrue(self.probe.wait_for_text("stamp_probe: ready"), self.probe.output())
        for name in chain.COMPONENTS:
            self.start(name)
        self.addCleanup(self.kill_all)
        self.wait_for_samples("slam", WARM_UP_FRAMES, 0, 30)

    def start(self, name):
        log = self.folder / f"{name}_{len(list(self.folder.iterdir()))}.log"
        arguments = ["--set", f"{name}.output_dir={self.folder / 'run'}"]
        if name == "sensor_replay":
            arguments = [chain.recording(), "--rate", "1", "--labels", chain.recording() / "classes.csv",
                         "--set", "sensor_replay.wait_for_readers=3"]
        self.processes[name] = chain.start(name, log, *arguments)

    def kill_all(self):
        for process in self.processes.values():
            process.kill()

    def wait_for_samples(self, topic, count, begin, seconds, fits=lambda _: True):
        """Waits for so many samples of a topic that fit, in the probe's lines from `begin` on."""
        def find(lines):
            fitting = [sample for sample in samples(lines[begin:], topic) if fits(sample)]
            return fitting if len(fitting) >= count else None
        found = self.probe.wait_for(find, seconds)
        self.assertIsNotNone(found, f"less than {count} samples of {topic} within {seconds} s\n" + self.logs())
        return found

    def logs(self):
        tails = {name: "\n".join(process.lines()[-8:]) for name, process in self.processes.items()}
        return "\n".join(f"-- {name}\n{tail}" for name, tail in tails.items())

    def position(self):
        return len(self.probe.lines())

    def kill_and_restart(self, name):
        """Kills and restarts a process; returns the probe's position, and the newest camera stamp, when it is ready."""
        self.processes[name].kill()
        begin = self.position()
        for topic in {"slam": ["camera"], "semantic_mapper": ["camera", "slam"],
                      "evaluator": ["camera", "slam", "semantic_mapper"], "sensor_replay": []}[name]:
            self.wait_for_samples(topic, 2, begin, 10)
        self.assert_alive(other for other in chain.COMPONENTS if other != name)
        self.start(name)
        lines = self.probe.lines()
        return len(lines), samples(lines, "camera")[-1].stamp

    def assert_alive(self, names):
        for name in names:
            self.assertTrue(self.processes[name].is_alive(), self.processes[name].output())

    def wait_for_answer(self, name, topic, begin, fits):
        began = time.monotonic()
        self.wait_for_samples(topic, 1, begin, ANSWER_S, fits)
        print(f"figure: {topic} again {time.monotonic() - began:.2f} s after {name} was ready")
        self.assert_alive(chain.COMPONENTS)

    def stop_all(self):
        """The run ends as any other: everybody exits with 0, and the files are whole."""
        for name in ("sensor_replay", "slam", "semantic_mapper", "evaluator"):
            self.assertEqual(self.processes[name].stop(seconds=ENDED_WITHIN_S), 0, self.processes[name].output())
        self.assertTrue(chain.is_map_whole(self.folder / "run/map.lapis"))
        self.assertGreater(chain.metrics_of(self.folder / "run")["frames_tracked"], 0)

    def test_slam(self):
        begin, restart = self.kill_and_restart("slam")
        self.wait_for_answer("slam", "slam", begin, lambda sample: sample.stamp > restart)
        self.wait_for_answer("slam", "semantic_mapper", begin, lambda sample: sample.stamp > restart)
        self.stop_all()

    def test_semantic_mapper(self):
        begin, restart = self.kill_and_restart("semantic_mapper")
        self.wait_for_answer("semantic_mapper", "semantic_mapper", begin, lambda sample: sample.stamp > restart)
        self.stop_all()

    def test_evaluator(self):
        # Its output on a topic is the number of frames it has judged, and it has judged none before the restart.
        begin, _ = self.kill_and_restart("evaluator")
        self.wait_for_answer("evaluator", "diagnostics", begin,
                             lambda sample: sample.detail[0] == "evaluator" and int(sample.detail[1]) > 0)
        self.stop_all()

    def test_sensor_replay(self):
        # The recording begins anew: stamps go back, as from a clock that was set. slam and the mapper answer with these
        # stamps, in the same map where slam recognises the place.
        begin, before = self.kill_and_restart("sensor_replay")
        self.wait_for_answer("sensor_replay", "camera", begin, lambda sample: sample.stamp < before)
        self.wait_for_answer("sensor_replay", "slam", begin, lambda sample: sample.stamp < before)
        self.wait_for_answer("sensor_replay", "semantic_mapper", begin, lambda sample: sample.stamp < before)
        self.stop_all()


if __name__ == "__main__":
    chain.main()
