#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame.hpp"
#include "slam/core/loop_detector.hpp"
#include "slam/core/map.hpp"
#include "slam/core/pose_graph.hpp"
#include "slam/core/slam_state.hpp"
#include "slam/core/wheel_calibration.hpp"

namespace lapis::slam {

/// kTracking: by vision, or by surfaces where features are too few; or the map begins anew where odometry says.
/// kDeadReckoning: neither has a pose, wheel odometry
/// carries the last one on. kLost: nothing is known.
enum class TrackingState : std::uint8_t { kInitializing, kTracking, kDeadReckoning, kLost };

/// Where a pose comes from. Each source is worse than the one before.
enum class PoseSource : std::uint8_t { kNone, kVision, kSurfaces, kOdometry };

/// What one frame gave. Poses are those of the camera's optical frame.
struct TrackingResult {
  TrackingState state = TrackingState::kInitializing;
  PoseSource source = PoseSource::kNone;
  std::string reason;  ///< why there is no pose; empty when tracking
  bool is_keyframe = false;
  std::uint64_t keyframe_id = 0;  ///< reference key-frame; the frame itself when is_keyframe
  std::uint64_t graph_version = 0;
  geometry::Pose T_map_keyframe = geometry::Pose::Identity();     ///< valid only when tracking or dead reckoning
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();  ///< the same; never corrected later
  /// Covariance of T_keyframe_camera, right perturbation (translation, rotation); zero for a key-frame itself.
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  /// Covariance of T_map_keyframe * T_keyframe_camera: `covariance` on top of the edges back to the first key-frame.
  geometry::Matrix6d map_covariance = geometry::Matrix6d::Zero();
  std::uint32_t features = 0;
  std::uint32_t matches = 0;
  std::uint32_t inliers = 0;
  double rms_px = 0.0;  ///< reprojection error of the inliers
  /// Sigma of position [m] and rotation [rad] by odometry since vision or surfaces held the pose last; 0 while they do.
  double drift_m = 0.0, drift_rad = 0.0;
};

/// True when the result says where the camera is.
inline bool has_pose(const TrackingResult& result) {
  return result.state == TrackingState::kTracking || result.state == TrackingState::kDeadReckoning;
}

/// Loops that the map has closed.
struct LoopSummary {
  std::size_t closures = 0;        ///< edges of the graph
  std::optional<time::Time> last;  ///< stamp of the key-frame that found the newest
  std::vector<Revisit> revisits;   ///< recognised and confirmed, more than there are edges
  std::size_t removed = 0;         ///< closed, and found to be wrong later
};

/// RGB-D SLAM: features and surfaces aligned with a local map, local bundle adjustment, loop closure, pose graph.
/// Deterministic: the same frames give the same bits, although the graph is optimised in another thread.
class RgbdSlam {
 public:
  /// `T_map_first_camera`: pose given to the first key-frame; `T_base_camera`: where the camera is on the robot, for
  /// wheel odometry.
  RgbdSlam(const SlamConfig& config, const geometry::Pose& T_map_first_camera,
           const geometry::Pose& T_base_camera = geometry::Pose::Identity());
  /// Resumes a saved map; `state` is sound (find_fault) and has the configuration's scale factor. It is lost until
  /// it finds its place in that map. Ids and graph version continue.
  RgbdSlam(const SlamConfig& config, const geometry::Pose& T_base_camera, SlamState state);
  ~RgbdSlam();

  /// Wheel odometry: the pose of base_link in a frame that may drift. Readings come in the order of their stamps and,
  /// to be of use for a frame, before it. False when the reading cannot be used.
  bool add_odometry(time::Time stamp, const geometry::Pose& T_odom_base);
  /// Tracks one frame; frames come in the order of their stamps. Bad frames give a result with a reason.
  TrackingResult process(const RgbdFrame& frame);

  /// T_odom_base at a stamp, where there is odometry.
  std::optional<geometry::Pose> odometry_at(time::Time stamp) const;
  /// What to report of a frame that cannot be processed: it has the pose of dead reckoning or none.
  TrackingResult skip(time::Time stamp, const std::string& reason) const;
  /// Waits for optimisations under way and applies them: what the map is at the end.
  void settle();
  PoseGraphSnapshot pose_graph() const;
  LoopSummary loops() const;
  /// What has to be kept to continue later. The large parts are shared with the map, not copied.
  SlamState state() const;
  /// Grows with every new key-frame and every change of a key-frame's pose.
  std::uint64_t graph_version() const;
  std::size_t keyframe_count() const;
  std::size_t landmark_count() const;
  const Map& map() const;
  /// Motions of odometry between key-frames that were left out (OdometryConfig::max_disagreement).
  std::size_t slip_count() const;
  /// What is known of the wheels; none as long as there is no odometry.
  std::optional<WheelCalibration> wheels() const;
  /// Recognised places that were not believed, because odometry contradicted them.
  std::size_t places_doubted() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::slam
