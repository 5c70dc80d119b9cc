#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// Relative pose of two key-frames that does not come from features, but from surfaces or odometry. The information is
/// that of a right perturbation (translation, rotation) [1/m^2, 1/rad^2].
struct KeyframeLink {
  KeyframeId from = 0;
  KeyframeId to = 0;
  geometry::Pose T_from_to = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();
};

}  // namespace lapis::slam
