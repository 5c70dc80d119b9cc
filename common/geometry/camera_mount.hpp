#pragma once

#include "common/geometry/se3.hpp"

namespace lapis::geometry {

/// Mounting of the camera on the robot: straight above the origin of base_link, looking forward and down.
struct CameraMount {
  double height_m = 0.0;        ///< above base_link, 0 to 10
  double pitch_down_rad = 0.0;  ///< positive looks towards the floor, -pi/2 to pi/2
};

/// Pose of camera_link in base_link; both x forward, y left, z up [REP 103].
Pose T_base_link(const CameraMount& mount);

/// Pose of the optical frame (x right, y down, z forward) in camera_link: roll -pi/2, pitch 0, yaw -pi/2 [REP 103].
Pose T_link_optical();

/// Pose of the camera's optical frame in base_link.
Pose T_base_camera(const CameraMount& mount);

}  // namespace lapis::geometry
