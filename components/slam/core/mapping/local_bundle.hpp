#pragma once

#include <vector>

#include "slam/core/config.hpp"
#include "slam/core/map/keyframe_link.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/mapping/bundle_adjuster.hpp"

namespace lapis::slam {

/// Adjusts the newest key-frame, its covisible ones and their landmarks. Key-frames outside this window that see the
/// same landmarks are fixed; when there are none, the oldest one of the window is. Observations that fit badly
/// afterwards are removed. Returns the key-frames that may have moved, ascending.
std::vector<KeyframeId> adjust_local_map(const SlamConfig& config, const std::vector<KeyframeLink>& links, Map& map);

}  // namespace lapis::slam
