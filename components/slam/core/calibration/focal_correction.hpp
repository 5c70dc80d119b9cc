#pragma once

#include "slam/core/config.hpp"
#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// Whether a map can be made anew from the features of its key-frames: it is small, vision connects all key-frames, and
/// it has no loops, of which the key-frames do not share landmarks, and no sub-maps.
bool can_be_remade(const Map& map, const SlamGraph& graph);

/// Bundle adjustment of all key-frames and their landmarks. The first key-frame stays where it is.
void adjust_whole_map(const SlamConfig& config, Map& map);

/// Makes a map anew for `ratio` times the focal length that its key-frames have, and adjusts it.
void remake_map(const SlamConfig& config, double ratio, Map& map);

}  // namespace lapis::slam
