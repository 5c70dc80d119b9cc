#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace lapis::controller {

/// Pose in the plane of the floor. `T_a_b` takes coordinates in frame b to frame a [m].
using PlanarPose = Eigen::Isometry2d;

inline PlanarPose planar_pose(const Eigen::Vector2d& position, double yaw_rad) {
  return PlanarPose(Eigen::Translation2d(position) * Eigen::Rotation2Dd(yaw_rad));
}

/// Heading of a pose, positive to the left of x, in [-pi, pi] rad.
inline double yaw_of(const PlanarPose& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

/// Direction of a vector, positive to the left of x, in [-pi, pi] rad.
inline double bearing(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

/// The same angle in [-pi, pi] rad.
inline double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace lapis::controller
