#!/usr/bin/env python3
"""What the supervisor does about processes that hang, about a slow disk, and about a run folder that is in use."""
import contextlib
import fcntl
import os
import signal
import time

import chain

# slam last: it comes back with a new map, and the mapper announces a save of the old one, in which it may be silent.
PARTICIPANTS = ("semantic_mapper", "planner", "controller", "evaluator", "slam")
REPLACED_WITHIN_S = 5.0
ENDED_WITHIN_S = 5.0  # a run whose source of frames hangs
CTRL_C_WITHIN_S = 10.0


class SupervisionCase(chain.ChainTest):
    def explore(self, name, *options, environment=()):
        scene = self.folder / "flat.yaml"
        scene.write_text(chain.FLAT, encoding="utf-8")
        run = chain.Process(["env", *environment, chain.REPOSITORY / "launch_scripts/explore.sh", "--scene", scene,
                             "--out", self.folder / name, *options], self.folder / f"{name}.log")
        self.addCleanup(run.kill)
        return run

    def wait_until_it_drives(self, run):
        self.assertTrue(run.wait_for_text(" m driven", 60), run.output())

    def process_of(self, run, name):
        pids = [pid for pid, program in chain.processes_of(run.run).items() if program == f"lapis_{name}"]
        self.assertEqual(len(pids), 1, run.output())
        return pids[0]

    def hang(self, run, name):
        """Stops a process as one that hangs stops; returns its id."""
        pid = self.process_of(run, name)
        os.kill(pid, signal.SIGSTOP)
        return pid

    @contextlib.contextmanager
    def held_save(self, *options):
        """A run whose mapper waits for the disk in a save, until the end of the block."""
        gate = self.folder / "gate"
        gate.touch()
        with open(gate, encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            run = self.explore("run", "--freerun", "--set", "semantic_mapper.save_period_s=4", *options,
                               environment=(f"LD_PRELOAD={chain.BIN}/lapis_slow_disk.so", f"LAPIS_DISK_GATE={gate}"))
            part = self.folder / "run/map.lapis.part"
            self.assertTrue(run.wait_for(lambda _: part.exists(), 60), run.output())
            yield run
            self.assertTrue(part.exists(), "the save was not held")

    def hold_a_save(self, seconds):
        """The disk keeps a save waiting for so long, by the progress lines that come meanwhile, at most one in 2 s."""
        with self.held_save("--restart", "--duration", str(seconds + 20)) as run:
            begin, began = len(run.lines()), time.monotonic()
            is_held = run.wait_for(lambda lines: sum(" m driven" in line for line in lines[begin:]) > seconds / 2, 60)
            self.assertTrue(is_held, run.output())
            self.assertGreater(time.monotonic() - began, seconds)
        self.assertEqual(run.wait(120), 0, run.output())
        self.assertNotIn("silent", run.output())
        manifest = (self.folder / "run/manifest.yaml").read_text(encoding="utf-8")
        self.assertIn("  semantic_mapper: 0\n", manifest.split("restarts:\n")[1])
        self.assertTrue(chain.is_map_whole(self.folder / "run/map.lapis"))


class SupervisionTest(SupervisionCase):
    def test_a_hung_process_is_replaced_and_the_robot_touches_nothing(self):
        run = self.explore("run", "--freerun", "--restart", "--duration", "600", "--method", "nearest",
                           "--set", "semantic_mapper.save_period_s=600")
        self.wait_until_it_drives(run)
        for name in PARTICIPANTS:
            began = time.monotonic()
            hung = self.hang(run, name)
            self.assertTrue(run.wait_for_text(f"{name} was silent for ", 20), run.output())
            self.assertTrue(run.wait_for_text(f"{name} runs again", 20), run.output())
            took_s = time.monotonic() - began
            print(f"figure: {name} replaced after {took_s:.2f} s")
            self.assertLess(took_s, REPLACED_WITHIN_S, run.output())
            self.assertNotIn(hung, chain.processes_of(run.run))
        self.assertEqual(run.press_ctrl_c(CTRL_C_WITHIN_S), 130, run.output())
        self.assert_no_orphan(run)
        manifest = (self.folder / "run/manifest.yaml").read_text(encoding="utf-8")
        for name in PARTICIPANTS:
            self.assertIn(f"  {name}: 1\n", manifest.split("restarts:\n")[1])
        self.assertIn("  collisions: 0\n", manifest)

    def test_a_hung_source_of_frames_ends_the_run(self):
        run = self.explore("run", "--freerun", "--restart")
        self.wait_until_it_drives(run)
        began = time.monotonic()
        self.hang(run, "simulator")
        self.assertEqual(run.wait(20), 1, run.output())
        took_s = time.monotonic() - began
        print(f"figure: ended after {took_s:.2f} s")
        self.assertLess(took_s, ENDED_WITHIN_S, run.output())
        self.assertIn("simulator: was silent for ", run.output())
        self.assert_no_orphan(run)
        self.assertTrue(chain.is_map_whole(self.folder / "run/map.lapis"))
        self.assertGreater(chain.metrics_of(self.folder / "run")["frames_tracked"], 0)

    def test_ctrl_c_ends_a_run_in_which_a_process_hangs(self):
        for name in ("semantic_mapper", "simulator"):
            with self.subTest(name):
                run = self.explore(name)
                self.wait_until_it_drives(run)
                self.hang(run, name)
                self.assertEqual(run.press_ctrl_c(CTRL_C_WITHIN_S), 130, run.output())
                self.assertIn(f"{name} did not end and was killed", run.output())
                self.assert_no_orphan(run)
                self.assertGreater(chain.metrics_of(self.folder / name)["frames_tracked"], 0)

    def test_a_run_folder_belongs_to_one_run(self):
        first = self.explore("run", "--duration", "6")
        self.wait_until_it_drives(first)
        began = time.monotonic()
        second = chain.Process([chain.REPOSITORY / "launch_scripts/explore.sh", "--out", self.folder / "run"],
                               self.folder / "second.log")
        self.addCleanup(second.kill)
        self.assertEqual(second.wait(10), 2, second.output())
        self.assertLess(time.monotonic() - began, 2.0)
        self.assertIn(f"{self.folder / 'run'} is in use by explore.sh --scene ", second.output())
        self.assertEqual(first.wait(120), 0, first.output())
        self.assertEqual(chain.metrics_of(self.folder / "run")["exit_reason"], "completed")
        self.assertTrue(chain.is_map_whole(self.folder / "run/map.lapis"))

    def test_a_slow_disk_kills_nobody(self):
        self.hold_a_save(5)


class LongSupervisionTest(SupervisionCase):
    def test_a_disk_that_takes_twenty_seconds_kills_nobody(self):
        self.hold_a_save(20)

    def test_a_hung_process_leaves_the_others_the_time_that_they_need(self):
        with self.held_save() as run:
            self.hang(run, "controller")
            self.assertIsNone(run.wait_for(lambda _: not run.is_alive(), CTRL_C_WITHIN_S + 2), run.output())
        self.assertEqual(run.wait(60), 1, run.output())
        self.assertIn("controller: was silent for ", run.output())
        self.assertNotIn("did not end and was killed", run.output())
        self.assertTrue(chain.is_map_whole(self.folder / "run/map.lapis"))
        self.assertGreater(chain.metrics_of(self.folder / "run")["frames_tracked"], 0)


if __name__ == "__main__":
    chain.main()
