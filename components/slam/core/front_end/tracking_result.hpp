#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/se3.hpp"

namespace lapis::slam {

/// kTracking: the pose is by vision, by surfaces where features are too few, or by odometry where the map continues at
/// its pose. kDeadReckoning: neither vision nor surfaces have a pose, and wheel odometry propagates the last one.
/// kLost: there is no pose. kUnconnected: tracked in a sub-map, whose place in the map is not known, so that there is
/// no pose in the map.
enum class TrackingState : std::uint8_t { kInitializing, kTracking, kDeadReckoning, kLost, kUnconnected };

/// Source of a pose, from the best (kVision) to the worst.
enum class PoseSource : std::uint8_t { kNone, kVision, kSurfaces, kOdometry };

/// Result for one frame. Poses are those of the camera's optical frame.
struct TrackingResult {
  TrackingState state = TrackingState::kInitializing;
  PoseSource source = PoseSource::kNone;
  std::string reason;  ///< why vision and surfaces give no pose; empty when tracking
  bool is_keyframe = false;
  std::uint64_t keyframe_id = 0;  ///< reference key-frame; the frame itself when is_keyframe
  std::uint64_t graph_version = 0;
  geometry::Pose T_map_keyframe = geometry::Pose::Identity();  ///< valid only when has_pose()
  /// Valid when has_pose(), or unconnected; never corrected later.
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();
  /// Covariance of T_keyframe_camera, right perturbation (translation, rotation) [m^2, rad^2]; zero for a key-frame.
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  /// Covariance of T_map_keyframe * T_keyframe_camera: `covariance` compounded with that of the key-frame in the map.
  geometry::Matrix6d map_covariance = geometry::Matrix6d::Zero();
  std::uint32_t features = 0;
  std::uint32_t matches = 0;
  std::uint32_t inliers = 0;
  double rms_px = 0.0;  ///< RMS reprojection error of the inliers
  /// Largest sigma of position [m] and rotation [rad] that odometry has accumulated since vision or surfaces last gave
  /// the pose; 0 while they do.
  double drift_m = 0.0, drift_rad = 0.0;
};

/// True when the result says where the camera is in the map.
inline bool has_pose(const TrackingResult& result) {
  return result.state == TrackingState::kTracking || result.state == TrackingState::kDeadReckoning;
}

}  // namespace lapis::slam
