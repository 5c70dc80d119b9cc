#pragma once

#include <optional>
#include <vector>

#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/surface_tracker.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Decides whether a pose may be believed. One near where motion leads is. Any other, found by recognising a place, has
/// to be distinct; what more it needs depends on odometry:
/// - without odometry, not to see through walls and furniture that should be in view, and to be within reach of the
///   last pose, or found again by the frames that follow;
/// - with odometry that may have erred so much (slip), to be found again;
/// - with odometry that contradicts it, evidence: buildings repeat themselves, and frames that follow show the same
///   furniture again. Views that share no landmarks have to agree along metres of path; where the camera has refuted
///   odometry as well, a turn that shows them is enough.
class Relocalizer {
 public:
  explicit Relocalizer(const SlamConfig& config)
      : config_(config.relocalization), graph_(config.pose_graph), surfaces_(config) {}

  /// Looks for the frame in the whole map; the best of the key-frames that resemble it. Not tracked when places apart
  /// from each other fit about as well.
  TrackOutcome search(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame) const;
  /// What a pose is compared with.
  struct Situation {
    const Map& map;
    const SlamGraph& graph;
    const MotionModel& motion;
    const Frame& frame;
    bool is_odometry_refuted = false;  ///< the camera does not see what it should where odometry says
    time::Time stamp() const { return frame.input->stamp; }
  };
  /// Whether the outcome is to be believed now; otherwise it is remembered, and its confirmation awaited.
  bool believes(const Situation& now, const TrackOutcome& outcome);
  /// Recognised places that odometry contradicted, and that were not believed at once for that.
  std::size_t doubted() const { return doubted_; }

 private:
  /// Found last, and so many times again.
  struct Found {
    time::Time stamp;
    geometry::Pose T_map_camera;
    int again = 0;
  };
  /// A place that odometry contradicts, beside the pose that is reported.
  struct Elsewhere {
    time::Time stamp;  // when it was found last
    KeyframeId reference = 0;
    geometry::Pose T_reference_camera;
    double path_m = 0.0, turned_rad = 0.0;  // since it was found first
    std::vector<LandmarkId> landmarks;      // that its views have shown, ascending
    int views = 1;                          // no two share landmarks
    int against = 0;                        // other places found since
  };
  /// How far apart poses may be.
  struct Reach {
    double m = 0.0, rad = 0.0;
  };
  /// Where odometry leads, if there is any, with the covariance of the path through the graph to the pose's reference.
  std::optional<MotionModel::Expected> expected(const Situation& now, KeyframeId reference) const;
  bool motion_leads_to(const Situation& now, KeyframeId reference, const geometry::Pose& T_map_camera) const;
  /// Whether the camera can be there, not long after it was seen last, when nothing says how it moved.
  bool is_within_reach(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// Whether clearly more than half of what the frame has in common with the place agrees, and gives the pose well:
  /// parts that repeat themselves, such as the floor of a corridor, do neither.
  bool is_distinct(const TrackOutcome& outcome) const;
  /// Whether walls and furniture of the place that should be in view are not there.
  bool sees_through_walls(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether odometry since the last pose may have erred so much.
  bool may_be_slip(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// True when the frames before have found the same.
  bool is_found_again(const Situation& now, const geometry::Pose& T_map_camera);
  /// A place that odometry contradicts: true when there is evidence enough.
  bool weigh(const Situation& now, const geometry::Pose& T_map_camera, const TrackOutcome& outcome);
  bool confirms(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// RelocalizationConfig::near_m and near_rad, and how far a camera can get in a time.
  Reach reach(double elapsed_s) const;
  /// The same, and three sigmas.
  Reach reach(const geometry::Matrix6d& covariance) const;
  static bool is_near(const geometry::Pose& T_expected, const geometry::Pose& T_found, const Reach& reach);

  RelocalizationConfig config_;
  PoseGraphConfig graph_;
  SurfaceTracker surfaces_;
  std::optional<Found> found_;
  std::optional<Elsewhere> elsewhere_;
  std::size_t doubted_ = 0;
};

}  // namespace lapis::slam
