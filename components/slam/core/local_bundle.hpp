#pragma once

#include <vector>

#include "slam/core/bundle_adjuster.hpp"
#include "slam/core/config.hpp"
#include "slam/core/map.hpp"

namespace lapis::slam {

/// Relative pose of two key-frames as something else than features gives it: surfaces, odometry.
struct KeyframeLink {
  KeyframeId from = 0;
  KeyframeId to = 0;
  geometry::Pose T_from_to = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();
};

/// Adjusts the newest key-frame, its covisible ones and their landmarks; key-frames outside the window that see the
/// same landmarks are fixed, and the oldest of the window when there are none. Observations that fit badly afterwards
/// are removed. Returns the key-frames that may have moved, ascending.
std::vector<KeyframeId> adjust_local_map(const SlamConfig& config, const std::vector<KeyframeLink>& links, Map& map);

}  // namespace lapis::slam
