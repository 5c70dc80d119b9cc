#pragma once

#include <optional>

#include "slam/core/loop_detector.hpp"
#include "slam/core/motion_model.hpp"
#include "slam/core/tracker.hpp"

namespace lapis::slam {

/// Decides whether a pose may be believed. One near where motion leads is; any other, found by recognising a place, has
/// to be found again by the frames that follow.
class Relocalizer {
 public:
  explicit Relocalizer(const RelocalizationConfig& config) : config_(config) {}

  /// Looks for the frame in the whole map; the best of the key-frames that resemble it.
  TrackOutcome search(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame) const;
  /// Whether the outcome, a pose at `stamp`, is to be believed now; otherwise it is remembered, and its confirmation
  /// awaited.
  bool believes(const Map& map, const MotionModel& motion, time::Time stamp, const TrackOutcome& outcome);

 private:
  bool motion_leads_to(const Map& map, const MotionModel& motion, time::Time stamp,
                       const geometry::Pose& T_map_camera) const;
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
  std::optional<Hypothesis> hypothesis_;
};

}  // namespace lapis::slam
