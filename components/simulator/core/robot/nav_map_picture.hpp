#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/path_planner.hpp"

namespace lapis::simulator {

/// A picture with one pixel per cell, north (+y) up: free cells are white, obstacles and the outside black, cells of
/// `reachable` (one pixel per cell, may be empty) tinted, and `lines` (tours, loops) have colours of their own.
geometry::ColorImage draw_nav_map(const NavMap& map, const geometry::GrayImage& reachable,
                                  const std::vector<Path>& lines = {});

/// Content of a PNG file.
std::vector<std::uint8_t> encode_png(const geometry::ColorImage& image);

}  // namespace lapis::simulator
