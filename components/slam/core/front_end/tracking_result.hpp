#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/se3.hpp"

namespace lapis::slam {

/// kTracking: by vision, or by surfaces where features are too few; or the map begins anew where odometry says.
/// kDeadReckoning: neither has a pose, wheel odometry carries the last one on. kLost: nothing is known.
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

}  // namespace lapis::slam
