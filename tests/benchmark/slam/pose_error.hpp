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

}  // namespace lapis::slam::benchmark
