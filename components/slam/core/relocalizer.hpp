#pragma once

#include <optional>
#include <vector>

#include "slam/core/loop_detector.hpp"
#include "slam/core/motion_model.hpp"
#include "slam/core/tracker.hpp"

namespace lapis::slam {

/// Decides whether a pose may be believed. One near where motion leads is. Any other, found by recognising a place, has
/// to be distinct; what more it needs depends on odometry:
/// - without odometry, to be within reach of the last pose, or found again by the frames that follow;
/// - with odometry that may have erred so much (slip), to be found again;
/// - with odometry that contradicts it, evidence: buildings repeat themselves, and frames that follow show the same
///   furniture again. Views that share no landmarks have to agree along metres of path.
class Relocalizer {
 public:
  explicit Relocalizer(const SlamConfig& config) : config_(config.relocalization), graph_(config.pose_graph) {}

  /// Looks for the frame in the whole map; the best of the key-frames that resemble it. Not tracked when places apart
  /// from each other fit about as well.
  TrackOutcome search(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame) const;
  /// Whether the outcome, a pose at `stamp`, is to be believed now; otherwise it is remembered, and its confirmation
  /// awaited.
  bool believes(const Map& map, const MotionModel& motion, time::Time stamp, const TrackOutcome& outcome);
  /// Recognised places that odometry contradicted, and that were not believed for that.
  std::size_t doubted() const { return doubted_; }

 private:
  /// A place that may be where the camera is, beside the pose that is reported.
  struct Hypothesis {
    time::Time stamp;             // when it was found last
    geometry::Pose T_map_camera;  // there
    int confirmed = 0;            // times that it was found again
    // Evidence against odometry:
    double path_m = 0.0;                // since it was found first
    std::vector<LandmarkId> landmarks;  // that its views have shown, ascending
    int views = 0;                      // no two share landmarks
    int against = 0;                    // other places found meanwhile
  };
  bool motion_leads_to(const Map& map, const MotionModel& motion, time::Time stamp,
                       const geometry::Pose& T_map_camera) const;
  /// Whether the camera can be there, not long after it was seen last, when nothing says how it moved.
  bool is_within_reach(const Map& map, const MotionModel& motion, time::Time stamp,
                       const geometry::Pose& T_map_camera) const;
  /// Whether clearly more than half of what the frame has in common with the place agrees, and gives the pose well:
  /// parts that repeat themselves, such as the floor of a corridor, do neither.
  bool is_distinct(const TrackOutcome& outcome) const;
  /// Whether odometry since the last pose may have erred so much.
  bool may_be_slip(const Map& map, const MotionModel& motion, time::Time stamp,
                   const geometry::Pose& T_map_camera) const;
  /// Remembers what is found again, or begins anew with it.
  void remember(const MotionModel& motion, time::Time stamp, const geometry::Pose& T_map_camera);
  /// A place that odometry contradicts: true when there is evidence enough.
  bool weigh(const MotionModel& motion, time::Time stamp, const geometry::Pose& T_map_camera,
             const TrackOutcome& outcome);
  bool confirms(const MotionModel& motion, time::Time stamp, const geometry::Pose& T_map_camera) const;
  /// How many times RelocalizationConfig::near_m and near_rad a camera can get away in a time.
  double reach(double elapsed_s) const;
  bool is_near(const geometry::Pose& T_expected, const geometry::Pose& T_found, double reach) const;

  RelocalizationConfig config_;
  PoseGraphConfig graph_;
  std::optional<Hypothesis> hypothesis_;  // waits for the next frames
  std::optional<Hypothesis> elsewhere_;   // odometry contradicts it
  std::size_t doubted_ = 0;
};

}  // namespace lapis::slam
