#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/path_planner.hpp"

namespace lapis::simulator {

/// One pixel per cell, north (+y) up: free white, obstacles and outside black, cells of `reachable` (one pixel per
/// cell, may be empty) tinted, `lines` (tours, loops) drawn in colours of their own.
geometry::ColorImage draw_nav_map(const NavMap& map, const geometry::GrayImage& reachable,
                                  const std::vector<Path>& lines = {});

/// Content of a PNG file.
std::vector<std::uint8_t> encode_png(const geometry::ColorImage& image);

}  // namespace lapis::simulator
