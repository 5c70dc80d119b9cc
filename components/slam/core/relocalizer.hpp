#pragma once

#include <optional>

#include "slam/core/loop_detector.hpp"
#include "slam/core/motion_model.hpp"
#include "slam/core/tracker.hpp"

namespace lapis::slam {

/// Decides whether a pose may be believed. One near where motion leads is; any other, found by recognising a place, has
/// to be distinct, and within reach or found again by the frames that follow.
class Relocalizer {
 public:
  explicit Relocalizer(const SlamConfig& config) : config_(config.relocalization), graph_(config.pose_graph) {}

  /// Looks for the frame in the whole map; the best of the key-frames that resemble it.
  TrackOutcome search(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame) const;
  /// Whether the outcome, a pose at `stamp`, is to be believed now; otherwise it is remembered, and its confirmation
  /// awaited.
  bool believes(const Map& map, const MotionModel& motion, time::Time stamp, const TrackOutcome& outcome);

 private:
  bool motion_leads_to(const Map& map, const MotionModel& motion, time::Time stamp,
                       const geometry::Pose& T_map_camera) const;
  /// Whether the camera can be there, not long after it was seen last, when nothing says how it moved.
  bool is_within_reach(const Map& map, const MotionModel& motion, time::Time stamp,
                       const geometry::Pose& T_map_camera) const;
  /// Whether clearly more than half of what the frame has in common with the place agrees, and gives the pose well:
  /// parts that repeat themselves, such as the floor of a corridor, do neither.
  bool is_distinct(const TrackOutcome& outcome) const;
  bool confirms(const MotionModel& motion, time::Time stamp, const geometry::Pose& T_map_camera) const;
  /// How many times RelocalizationConfig::near_m and near_rad a camera can get away in a time.
  double reach(double elapsed_s) const;
  bool is_near(const geometry::Pose& T_expected, const geometry::Pose& T_found, double reach) const;

  struct Hypothesis {
    time::Time stamp;
    geometry::Pose T_map_camera;
    int confirmed = 0;
  };
  RelocalizationConfig config_;
  PoseGraphConfig graph_;
  std::optional<Hypothesis> hypothesis_;
};

}  // namespace lapis::slam
