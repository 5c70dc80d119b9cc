#!/usr/bin/env python3
"""Recorded RGB-D through the whole chain: accuracy of trajectory and map, and everything that a run leaves."""
import math

import chain

FILES = ("manifest.yaml", "trajectory_estimate.txt", "trajectory_ground_truth.txt", "keyframes.txt", "pose_graph.g2o",
         "slam.lapis", "map.lapis", "map.ot", "map.ply", "reference_map.lapis", "timeline.csv", "frames.csv", "metrics.json",
         "figures/trajectory.png", "figures/errors.png", "figures/progress.png",
         *(f"logs/{name}.log" for name in chain.COMPONENTS))
MEASURED = ("exit_reason", "frames_total", "frames_tracked", "tier_vision_share",
            "tier_surfaces_share", "tier_odometry_share", "lost_share", "lost_time_s", "loop_closures", "ate_se3_rmse_m",
            "ate_origin_rmse_m", "ate_raw_rmse_m", "rpe_1m_rmse_m", "heading_rmse_rad", "keyframe_ate_se3_rmse_m",
            "keyframe_ate_origin_rmse_m", "keyframe_ate_raw_rmse_m", "correction_rmse_m", "ate_per_metre", "map_error_mean_m",
            "map_error_p95_m", "map_completeness_mean_m", "reference_fusion_share", "explored_volume_m3",
            "path_length_m", "real_time_factor", "duration_s", "wall_time_s", "cpu_ms_per_frame", "peak_rss_mb",
            "run")
OF_LABELS = ("iou_top8_mean", "iou_mean", "iou_by_class")
OF_GROUND_TRUTH = ("explored_share", "explored_share_with_margin", "stalled_share",
                   *(f"{prefix}_{key}" for prefix in ("ideal", "mesh")
                     for key in ("map_error_mean_m", "map_error_p95_m", "map_completeness_mean_m", *OF_LABELS)))
NOT_MEASURED = ("ate_at_80_m", "time_to_80_s", "time_to_90_s", "failures", "collisions", "planner_state",
                "planner_reason", "decisions", "decision_time_p50_s", "decision_time_p95_s",
                *(f"{prefix}_{key}" for prefix in ("full", "floor")
                  for key in ("map_error_mean_m", "map_error_p95_m", "map_completeness_mean_m", *OF_LABELS)))
SHORT_S = 12  # more than a metre


class ReplayMetricsTest(chain.ChainTest):
    def check_run(self, folder, frames, measured, null, figures=()):
        """What holds for any complete run; returns its metrics."""
        for file in (*FILES, *figures):
            path = folder / file
            self.assertTrue(path.is_file() and path.stat().st_size > 0, path)
        self.assertEqual(list(folder.rglob("*.part*")), [])
        self.assertIn("  sensor_replay: 0\n", (folder / "manifest.yaml").read_text())
        metrics = chain.metrics_of(folder)
        chain.print_figures(folder.name, metrics)
        self.assertEqual(set(metrics), {*measured, *null})
        self.assertEqual([key for key in measured if metrics[key] is None], [])
        self.assertEqual([key for key in null if metrics[key] is not None], [])
        self.assertEqual(set(metrics["run"]), {"system", "data_set", "duration_s", "commit"})
        self.assertEqual(set(metrics["cpu_ms_per_frame"]), set(chain.COMPONENTS))
        self.assertTrue(all(math.isfinite(v) and v > 0 for v in metrics["cpu_ms_per_frame"].values()), metrics)
        self.assertEqual((metrics["exit_reason"], metrics["frames_total"], metrics["frames_tracked"]),
                         ("completed", frames, frames))
        self.assertTrue(chain.is_map_whole(folder / "map.lapis"))
        estimate = (folder / "trajectory_estimate.txt").read_text().splitlines()
        self.assertEqual(sum(not line.startswith("#") for line in estimate), frames)
        return metrics

    def test_recording_with_labels_and_ground_truth(self):
        source = chain.recording()
        frames = len((source / "associations.txt").read_text().splitlines())
        folder = self.play(source, "whole", "--labels", source / "classes.csv")
        metrics = self.check_run(folder, frames, MEASURED + OF_LABELS + OF_GROUND_TRUTH, NOT_MEASURED,
                                 ["figures/class_iou.png"])
        self.assertGreater(metrics["loop_closures"], 0)
        self.assertLessEqual(metrics["ate_se3_rmse_m"], 0.02)
        self.assertLessEqual(metrics["map_error_mean_m"], 0.01)
        self.assertGreaterEqual(metrics["reference_fusion_share"], 0.90)
        self.assertGreaterEqual(metrics["iou_top8_mean"], 0.90)

    def test_what_is_not_known_is_not_made_up(self):
        bare = self.folder / "bare"
        bare.mkdir()
        for part in ("rgb", "depth", "camera.yaml", "associations.txt", "groundtruth.txt"):
            (bare / part).symlink_to(chain.recording() / part)
        folder = self.play(bare, "short", "--duration", str(SHORT_S))
        self.check_run(folder, 15 * SHORT_S, MEASURED, OF_LABELS + OF_GROUND_TRUTH + NOT_MEASURED)


if __name__ == "__main__":
    chain.main()
