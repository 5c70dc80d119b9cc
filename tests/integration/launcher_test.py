#!/usr/bin/env python3
"""replay.sh when something goes wrong: it says what, ends everything it started, and its status says so."""
import os
import signal

import chain


class LauncherTest(chain.ChainTest):
    def start_replay(self, name="run", progress_lines=1):
        """The launcher, while it plays: so many progress lines have come, the first one with the first frame."""
        run = chain.replay(chain.recording(), self.folder / name)
        self.addCleanup(run.kill)
        progress = "frame "
        is_playing = run.wait_for(lambda lines: sum(line.startswith(progress) for line in lines) >= progress_lines)
        self.assertTrue(is_playing, run.output())
        return run

    def assert_refused(self, run, *texts):
        """Bad set-up: status 2, a line that helps, nothing left behind."""
        self.addCleanup(run.kill)
        self.assertEqual(run.wait(), 2, run.output())
        for text in texts:
            self.assertIn(text, run.output())
        self.assert_no_orphan(run)

    def test_killed_child_is_named_and_the_others_are_ended(self):
        for victim in chain.COMPONENTS:
            with self.subTest(victim):
                run = self.start_replay(victim)
                pids = [pid for pid, name in chain.processes_of(run.run).items() if name == f"lapis_{victim}"]
                self.assertEqual(len(pids), 1, run.output())
                os.kill(pids[0], signal.SIGKILL)
                self.assertEqual(run.wait(), 1, run.output())
                self.assertIn(f"replay.sh: {victim}: ", run.output())
                self.assertIn("status 137", run.output())
                self.assert_no_orphan(run)
                self.assertIn(f"  {victim}: 137\n", (self.folder / victim / "manifest.yaml").read_text())

    def test_interrupted(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(number.name):
                # The second line comes after two seconds of work; the recording is far from its end then.
                run = self.start_replay(number.name, progress_lines=2)
                self.assertEqual(run.stop(number), status, run.output())
                self.assert_no_orphan(run)
                self.assertIn(f"interrupted by {number.name}", run.output())
                self.assertIn("frames_tracked ", run.output())
                metrics = chain.metrics_of(self.folder / number.name)
                self.assertEqual(metrics["exit_reason"], "stopped")
                self.assertGreater(metrics["frames_tracked"], 0)
                self.assertTrue(chain.is_map_whole(self.folder / number.name / "map.lapis"))

    def test_children_end_with_a_launcher_that_is_killed(self):
        run = self.start_replay()
        run.kill()
        self.assert_no_orphan(run)

    def test_no_data_set(self):
        missing = self.folder / "nowhere"
        self.assert_refused(chain.replay(missing, self.folder / "run"), f"{missing}: no such folder")
        empty = self.folder / "empty"
        empty.mkdir()
        self.assert_refused(chain.replay(empty, self.folder / "run"), f"{empty}/rgb.txt: not found", "camera.yaml")

    def test_run_folder_that_cannot_be_made(self):
        file = self.folder / "file"
        file.touch()
        run = chain.replay(chain.recording(), file / "run", log=self.folder / "run.log")
        self.assert_refused(run, f"{file}/run cannot be made a run folder", "--out")

    def test_a_run_that_is_refused_leaves_the_earlier_one_alone(self):
        folder = self.play(chain.recording(), "run", "--duration", "2")
        own = folder / "figures/mine.png"
        own.parent.mkdir(exist_ok=True)
        own.touch()
        metrics = chain.metrics_of(folder)
        self.assert_refused(chain.replay(chain.recording(), folder, "--set", "slam.nonsense=1"), "slam.nonsense")
        self.assertEqual(chain.metrics_of(folder), metrics)
        self.assertTrue(chain.is_map_whole(folder / "map.lapis"))
        self.play(chain.recording(), "run", "--duration", "1")
        self.assertNotEqual(chain.metrics_of(folder)["frames_total"], metrics["frames_total"])
        self.assertTrue(own.exists(), "it was not the run's")

    def test_files_that_would_be_read_in_part_are_refused(self):
        for text, reason in (("robto: {radius_m: 0.3}", "robto: no process"),
                             ("robot: {radius_m: 0.3}\nslam: {max_feature_depth_m: 4}", "a file for each")):
            file = self.folder / "mine.yaml"
            file.write_text(text, encoding="utf-8")
            self.assert_refused(chain.replay("apartment", self.folder / "run", "--robot", file), str(file), reason)

    def test_whoever_reads_the_output_may_end_first(self):
        script = 'set -o pipefail; "$@" | head -n 1'
        run = chain.Process(["bash", "-c", script, "-", chain.REPOSITORY / "launch_scripts/replay.sh", chain.recording(),
                             "--duration", "5", "--out", self.folder / "run"], self.folder / "run.log")
        self.addCleanup(run.kill)
        self.assertEqual(run.wait(), 0, run.output())
        self.assertEqual(chain.metrics_of(self.folder / "run")["run"]["duration_s"], 5)

    def test_unknown_keys(self):
        run = chain.replay(chain.recording(), self.folder / "run", "--set", "resolution_m=0.1")
        self.assert_refused(run, "resolution_m=0.1: unknown key", "semantic_mapper.")
        run = chain.replay(chain.recording(), self.folder / "run", "--set", "slam.nonsense=1")
        self.assert_refused(run, "slam.nonsense", "unknown")
        run = chain.replay(chain.recording(), self.folder / "run", "--set", "semantic_mapper.resolution_m=0")
        self.assert_refused(run, "semantic_mapper.resolution_m", "0.02")

    def test_command_line(self):
        self.assert_refused(chain.replay(chain.recording(), self.folder / "run", "--duration"), "--duration needs a value")
        self.assert_refused(chain.replay(chain.recording(), self.folder / "run", "--fast"), "unknown option --fast")


if __name__ == "__main__":
    chain.main()
