#pragma once

#include <optional>
#include <vector>

#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/surface_tracker.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Decides whether a pose is believed. A pose near the one that motion predicts is. Any other pose, found by
/// recognising a place, has to be certain; what else it needs depends on odometry:
/// - without odometry since the last pose, it must not see through walls and furniture that should be in view, and it
///   has to be within reach of the last pose, or to be found again by the next frames;
/// - with odometry that may have erred by that much (slip), it has to be found again;
/// - with odometry that contradicts it, it needs evidence, because buildings repeat themselves, and the next frames
///   show the same furniture again. Views that share no landmarks have to agree along metres of path; where the camera
///   has refuted odometry as well, a turn that shows them is enough.
class Relocalizer {
 public:
  explicit Relocalizer(const SlamConfig& config)
      : config_(config.relocalization), graph_(config.pose_graph), surfaces_(config) {}

  /// Searches a part of the map (Keyframe::sub_map) for the frame, and returns the best match among the key-frames that
  /// resemble it. Not tracked when places that are apart from each other fit about as well.
  TrackOutcome search(const Map& map, KeyframeId sub_map, const LoopDetector& places, const Tracker& tracker,
                      const Frame& frame) const;
  /// What a pose is judged with.
  struct Situation {
    const Map& map;
    const SlamGraph& graph;
    const MotionModel& motion;
    const Frame& frame;
    bool is_odometry_refuted = false;  ///< the camera does not see what it should at the pose of odometry
    time::Time stamp() const { return frame.input->stamp; }
  };
  /// Whether the camera is where motion predicts it.
  bool motion_leads_to(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether the outcome is believed now; if not, it may be remembered until later frames confirm it.
  bool believes(const Situation& now, const TrackOutcome& outcome);
  /// Number of recognised places that were not believed at once because odometry contradicted them.
  std::size_t doubted() const { return doubted_; }

 private:
  /// The pose that was found last, and how many frames have found it again.
  struct Found {
    time::Time stamp;
    geometry::Pose T_map_camera;
    int again = 0;
  };
  /// A place that odometry contradicts, kept beside the pose that is reported.
  struct Elsewhere {
    time::Time stamp;  // when it was found last
    KeyframeId reference = 0;
    geometry::Pose T_reference_camera;
    double path_m = 0.0, turned_rad = 0.0;  // since it was found first
    std::vector<LandmarkId> landmarks;      // that its views have shown, ascending
    int views = 1;                          // number of views that share no landmarks
    int against = 0;                        // number of other places found since, in a row
  };
  /// How far apart poses may be.
  struct Reach {
    double m = 0.0, rad = 0.0;
  };
  /// Pose that odometry predicts, with the covariance of the path through the graph to `reference` included; without
  /// odometry that of MotionModel::expect.
  std::optional<MotionModel::Expected> expected(const Situation& now, KeyframeId reference) const;
  /// Whether the camera can be there, soon after the last pose, when nothing tells how it has moved.
  bool is_within_reach(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// Whether the matches determine the pose well. Parts that repeat themselves, such as the floor of a corridor, do
  /// not.
  bool is_certain(const TrackOutcome& outcome) const;
  /// Whether walls and furniture of the place that should be in view are missing.
  bool sees_through_walls(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether slip since the last pose may explain the difference from odometry.
  bool may_be_slip(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// Remembers the pose; true when enough frames in a row have found it.
  bool is_found_again(const Situation& now, const geometry::Pose& T_map_camera);
  /// Weighs a place that odometry contradicts: true when there is enough evidence for it.
  bool weigh(const Situation& now, const geometry::Pose& T_map_camera, const TrackOutcome& outcome);
  bool confirms(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// RelocalizationConfig::near_m and near_rad, enlarged by how far a camera can get in this time.
  Reach reach(double elapsed_s) const;
  /// near_m and near_rad, plus three sigmas.
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
