#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluator/core/map/iou.hpp"
#include "evaluator/core/map/map_metrics.hpp"
#include "evaluator/core/trajectory/association.hpp"

namespace lapis::evaluator {

/// Errors of one trajectory. Raw: both trajectories are in one frame and not aligned.
struct TrajectoryFigures {
  std::optional<double> ate_se3_rmse_m;
  std::optional<double> ate_origin_rmse_m;
  std::optional<double> ate_raw_rmse_m;
  std::optional<double> rpe_1m_rmse_m;     ///< translation, over 1 m of the true path
  std::optional<double> heading_rmse_rad;  ///< not aligned
};

/// One line of iou_by_class.
struct NamedClassIou {
  std::string name;
  ClassIou figures;
};

/// A map against one reference map.
struct MapFigures {
  std::optional<double> map_error_mean_m;
  std::optional<double> map_error_p95_m;
  std::optional<double> map_completeness_mean_m;
  std::optional<double> iou_top8_mean;
  std::optional<double> iou_mean;
  std::vector<NamedClassIou> iou_by_class;  ///< empty = not measured
};

/// Everything in metrics.json. A member without a value was not measured and is written as null, never 0. Times are
/// simulated or recorded seconds unless named otherwise.
struct RunMetrics {
  std::optional<std::string> exit_reason;
  std::optional<std::int64_t> frames_total;    ///< including frames that were not tracked
  std::optional<std::int64_t> frames_tracked;  ///< frames with a pose from vision or surfaces, without dead reckoning
  std::optional<double> tier_vision_share;     ///< share of duration_s in which vision gave the pose
  std::optional<double> tier_surfaces_share;
  std::optional<double> tier_odometry_share;
  std::optional<double> lost_share;   ///< share of duration_s without any pose
  std::optional<double> lost_time_s;  ///< time without any pose
  std::optional<std::int64_t> loop_closures;
  TrajectoryFigures online;                 ///< every frame's pose as published at its time
  TrajectoryFigures keyframes;              ///< final, optimised key-frames (their RPE and heading are not written)
  std::optional<double> correction_rmse_m;  ///< of key-frames: from the pose published at their time to the final pose
  std::optional<double> ate_at_80_m;
  std::optional<double> ate_per_metre;
  MapFigures map;                                ///< reference: the run's own frames at true poses
  MapFigures ideal_map;                          ///< reference: its frames rendered again without noise, at true poses
  MapFigures full_map;                           ///< reference: the whole building, without noise, at true poses
  MapFigures floor_map;                          ///< of the run's own frames at true poses, by the same reference
  MapFigures mesh_map;                           ///< reference: the scene's labelled voxels in line of sight
  std::optional<double> reference_fusion_share;  ///< share of the plain fusion's voxels that the reference map contains
  std::optional<double> explored_volume_m3;
  std::optional<double> explored_share;
  std::optional<double> explored_share_with_margin;
  std::optional<double> time_to_80_s;
  std::optional<double> time_to_90_s;
  std::optional<double> stalled_share;  ///< of the time before 90 % are explored
  std::optional<double> path_length_m;
  std::optional<std::int64_t> collisions;
  std::optional<std::string> planner_state;   ///< the last state
  std::optional<std::string> planner_reason;  ///< the reason for that state
  std::optional<std::int64_t> decisions;
  std::optional<std::int64_t> failures;       ///< goals that were not reached, or that were viewed in vain
  std::optional<double> decision_time_p50_s;  ///< wall-clock time
  std::optional<double> decision_time_p95_s;
  std::optional<double> real_time_factor;
  std::optional<double> duration_s;
  std::optional<double> wall_time_s;
  std::map<std::string, std::optional<double>> cpu_ms_per_frame;  ///< by process
  std::map<std::string, std::optional<double>> peak_rss_mb;       ///< by process
};

/// Figures of an estimate against a reference that is already expressed in the estimate's map frame.
TrajectoryFigures trajectory_figures(const Trajectory& reference, const Trajectory& estimate,
                                     const AssociationConfig& association = {});
/// ate_raw_rmse_m of the estimates up to the time at which the path of the reference is `path_m` long; none when the
/// path is shorter.
std::optional<double> ate_raw_rmse_up_to(double path_m, const Trajectory& reference, const Trajectory& estimate,
                                         const AssociationConfig& association = {});
/// Figures of a map against a reference on the same grid. Classes without an entry in `class_names` are named by their
/// id. Throws std::invalid_argument when the resolutions differ.
MapFigures map_figures(const LabelledVoxels& reference, const LabelledVoxels& estimate,
                       const std::map<std::uint16_t, std::string>& class_names,
                       const std::vector<std::uint16_t>& top_classes = {});

/// The document metrics.json: keys in a fixed order, numbers with all their digits; equal metrics give equal bytes.
/// Numbers that are not finite are written as null.
std::string to_json(const RunMetrics& metrics);
/// The same figures for a terminal, one line each, with "-" for figures that were not measured. Figures of single
/// classes are left out.
std::string format_table(const RunMetrics& metrics);

}  // namespace lapis::evaluator
