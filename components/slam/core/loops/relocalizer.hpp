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
/// - without odometry, walls and furniture that should be in view must be, the next frames have to find it again (right
///   after the last pose not even that), and it has to be where the last pose was: buildings repeat themselves, and the
///   camera may have been carried to a copy of the place. What is within reach then is docs/decisions/0069. Any other
///   place is left to a sub-map, which gathers evidence (MapJoiner);
/// - with odometry that began anew since the last pose, it has to be found again;
/// - with odometry that may have erred by that much (slip), it has to be found again;
/// - with odometry that contradicts it, it needs evidence, because the next frames show the same furniture again. Views
///   that share no landmarks have to agree along metres of path; where the camera has refuted odometry as well, a turn
///   that shows them is enough.
/// Where a copy is in the map as well, and nothing excludes it, neither of the two is believed.
class Relocalizer {
 public:
  explicit Relocalizer(const SlamConfig& config) : config_(config), surfaces_(config) {}

  /// What a pose is judged with.
  struct Situation {
    const Map& map;
    const SlamGraph& graph;
    const MotionModel& motion;
    const LoopDetector& places;
    const Tracker& tracker;
    const Frame& frame;
    KeyframeId reference = 0;          ///< key-frame beside which the camera was last, in the part that is searched
    bool is_odometry_refuted = false;  ///< the camera does not see what it should at the pose of odometry
    time::Time stamp() const { return frame.input->stamp; }
    KeyframeId sub_map() const { return map.keyframe(reference).sub_map; }
  };
  enum class Verdict {
    kBelieved,
    kAwaitsMore,  ///< it may be believed when later frames confirm it
    kNotHere,     ///< not by recovery: evidence for it has to be gathered in a sub-map
  };

  /// Compares the frame with one key-frame of the camera's part of the map: with the one that was recognised last, else
  /// with those that look alike in turn, frame by frame. So a frame of a lost camera costs little.
  TrackOutcome search(const Situation& now);
  /// Whether the camera is where motion predicts it.
  bool motion_leads_to(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether the outcome is believed now; if not, it may be remembered until later frames confirm it.
  Verdict judge(const Situation& now, const TrackOutcome& outcome);
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
  /// Where the camera was last, and how far from there a recognised place may be.
  struct Vicinity {
    geometry::Pose T_map_camera;
    Reach reach;
    bool excludes_copies = false;  ///< the camera cannot be in a copy of what is there
  };
  /// Pose that odometry predicts, with the covariance of the path through the graph to `reference` included; without
  /// odometry that of MotionModel::expect.
  std::optional<MotionModel::Expected> expected(const Situation& now, KeyframeId reference) const;
  /// Whether recovery needs the vicinity of the last pose, because sub-maps decide about other places.
  bool is_bound(const Situation& now) const;
  Vicinity vicinity(const Situation& now) const;
  std::vector<KeyframeId> candidates(const Situation& now) const;
  TrackOutcome compare(const Situation& now, KeyframeId keyframe) const;
  Verdict judge_unled(const Situation& now, const TrackOutcome& outcome);
  Verdict judge_bound(const Situation& now, const geometry::Pose& T_map_camera, const TrackOutcome& outcome);
  /// Whether the camera can be there, soon after the last pose, when nothing tells how it has moved.
  bool is_within_reach(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// Whether the matches determine the pose well. Parts that repeat themselves, such as the floor of a corridor, do
  /// not.
  bool is_certain(const TrackOutcome& outcome) const;
  /// Whether walls and furniture of the place that should be in view are missing.
  bool sees_through_walls(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether another place of the map, apart from this one, fits about as well.
  bool has_copy(const Situation& now, const TrackOutcome& outcome) const;
  /// Whether slip since the last pose may explain the difference from odometry.
  bool may_be_slip(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// Remembers the pose; true when enough frames in a row have found it.
  bool is_found_again(const Situation& now, const geometry::Pose& T_map_camera);
  /// ... and no other place fits as well; if one does, the count begins anew.
  bool is_found_alone(const Situation& now, const geometry::Pose& T_map_camera, const TrackOutcome& outcome);
  /// Weighs a place that odometry contradicts: true when there is enough evidence for it.
  bool weigh(const Situation& now, const geometry::Pose& T_map_camera, const TrackOutcome& outcome);
  bool confirms(const Situation& now, const geometry::Pose& T_map_camera) const;
  /// RelocalizationConfig::near_m and near_rad, enlarged by how far a camera can get in this time.
  Reach reach(double elapsed_s) const;
  /// near_m and near_rad, plus three sigmas.
  Reach reach(const geometry::Matrix6d& covariance) const;
  static bool is_near(const geometry::Pose& T_expected, const geometry::Pose& T_found, const Reach& reach);

  SlamConfig config_;
  SurfaceTracker surfaces_;
  std::optional<Found> found_;
  std::optional<Elsewhere> elsewhere_;
  std::optional<KeyframeId> recognized_;  // by the last search
  std::size_t turn_ = 0;                  // searches since something was recognised
  std::size_t doubted_ = 0;
};

}  // namespace lapis::slam
