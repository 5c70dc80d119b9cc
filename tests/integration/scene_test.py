#!/usr/bin/env python3
"""A tour of a simulated flat through the whole chain. Without the furniture package, so that it is the same everywhere."""
import os
import signal

import chain

SCENE = "apartment"
OPTIONS = (*chain.NO_FURNITURE, "--seed", "3")


class SceneTest(chain.ChainTest):
    # The folders have the same last name, because a figure has it in its title.
    def test_same_seed_same_bytes_and_all_references(self):
        first, second = (self.play(SCENE, name, *OPTIONS, "--duration", "8", "--set", f"simulator.render_threads={threads}")
                         for name, threads in (("first/run", 1), ("second/run", 2)))
        self.assert_same_run(first, second, chain.FILES + chain.FILES_OF_LABELS + chain.FILES_OF_TRUTH)
        metrics = chain.metrics_of(first)
        self.assertEqual(metrics["frames_total"], 120)
        self.assertEqual(metrics["frames_tracked"], 120)
        self.assertLess(metrics["ate_raw_rmse_m"], 0.05)
        self.assertEqual(metrics["collisions"], 0)
        for key in ("map_error_mean_m", "ideal_map_error_mean_m", "mesh_map_error_mean_m"):
            self.assertLess(metrics[key], 0.1, key)
        for key in ("iou_top8_mean", "ideal_iou_top8_mean", "explored_share"):
            self.assertGreater(metrics[key], 0.05, key)
        self.assertLess(metrics["explored_share"], 1.0)
        manifest = (first / "manifest.yaml").read_text()
        for text in ("scene: \"apartment\"", "scene_hash:", "seed: 3", "exit_reason: \"completed\"", "  simulator: 0"):
            self.assertIn(text, manifest)

    def test_a_killed_participant_ends_the_run_and_the_manifest_names_it(self):
        run = chain.replay(SCENE, self.folder / "run", *OPTIONS)
        self.addCleanup(run.kill)
        self.assertTrue(run.wait_for_text("real-time factor", 60), run.output())
        pids = [pid for pid, name in chain.processes_of(run.run).items() if name == "lapis_semantic_mapper"]
        os.kill(pids[0], signal.SIGKILL)
        self.assertEqual(run.wait(), 1, run.output())
        self.assert_no_orphan(run)
        self.assertIn("semantic_mapper: 137", (self.folder / "run/manifest.yaml").read_text())

    def test_an_interrupted_run_has_all_that_a_whole_one_has(self):
        run = chain.replay(SCENE, self.folder / "run", *OPTIONS)
        self.addCleanup(run.kill)
        self.assertTrue(run.wait_for_text("real-time factor", 60), run.output())
        self.assertEqual(run.press_ctrl_c(60), 130, run.output())
        self.assert_no_orphan(run)
        metrics = chain.metrics_of(self.folder / "run")
        for key in ("frames_tracked", "map_error_mean_m", "ideal_map_error_mean_m", "explored_share"):
            self.assertIsNotNone(metrics[key], key)
        self.assertIn('exit_reason: "stopped"', (self.folder / "run/manifest.yaml").read_text())

    def test_options_of_another_kind_of_source_are_refused(self):
        for source, option, value in ((SCENE, "--start", "1"), (SCENE, "--labels", "a.csv"), (SCENE, "--rate", "2"),
                                      (self.folder, "--seed", "1"), (self.folder, "--tour", "a.yaml")):
            with self.subTest(option), chain.replay(source, self.folder / "run", option, value) as run:
                self.assertEqual(run.wait(), 2, run.output())
                self.assertIn(option, run.output())

    def test_bad_scenes_are_named(self):
        run = chain.replay("no_such_scene", self.folder / "run")
        self.addCleanup(run.kill)
        self.assertEqual(run.wait(), 2, run.output())
        self.assertIn("scene no_such_scene: no such file", run.output())


if __name__ == "__main__":
    chain.main()
