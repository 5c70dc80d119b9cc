#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// Relative pose of two key-frames as something else than features gives it: surfaces, odometry.
struct KeyframeLink {
  KeyframeId from = 0;
  KeyframeId to = 0;
  geometry::Pose T_from_to = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();
};

}  // namespace lapis::slam
