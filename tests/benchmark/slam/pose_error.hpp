#pragma once

#include <numbers>

#include "common/geometry/se3.hpp"

namespace lapis::slam::benchmark {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< in a radian

/// Of a pose, or of a motion.
struct PoseError {
  double m = 0.0, rad = 0.0;
};

inline PoseError difference(const geometry::Pose& a, const geometry::Pose& b) {
  const geometry::Pose d = a.inverse() * b;
  return {d.translation().norm(), geometry::rotation_angle(d.linear())};
}

/// Whether a measured motion is another one than the true one: by more than 0.2 m or 0.1 rad.
inline bool is_wrong(const geometry::Pose& measured, const geometry::Pose& truth) {
  const PoseError error = difference(measured, truth);
  return error.m > 0.2 || error.rad > 0.1;
}

}  // namespace lapis::slam::benchmark
