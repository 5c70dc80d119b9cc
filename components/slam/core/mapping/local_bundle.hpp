#pragma once

#include <vector>

#include "slam/core/config.hpp"
#include "slam/core/map/keyframe_link.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/mapping/bundle_adjuster.hpp"

namespace lapis::slam {

/// Adjusts the newest key-frame, its covisible ones and their landmarks; key-frames outside the window that see the
/// same landmarks are fixed, and the oldest of the window when there are none. Observations that fit badly afterwards
/// are removed. Returns the key-frames that may have moved, ascending.
std::vector<KeyframeId> adjust_local_map(const SlamConfig& config, const std::vector<KeyframeLink>& links, Map& map);

}  // namespace lapis::slam
