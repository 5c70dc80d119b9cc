#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/grid.hpp"

namespace lapis::simulator {

/// The neighbours that belong to one region. Free space uses 4 and obstacles 8, so that the two never cross.
enum class Neighbours { kFour, kEight };

/// Connected regions of the cells that are not 0.
struct Regions {
  geometry::Image<std::uint32_t> labels;  ///< 0: no region; region i has label i + 1
  std::vector<std::size_t> sizes;         ///< cells of each region, in row-major order of their first cells
};
Regions find_regions(const geometry::GrayImage& cells, Neighbours neighbours);

/// 255 in the 4-connected region of cells that are not 0 around `seed`, else 0; all 0 when `seed` is 0.
geometry::GrayImage region_around(const geometry::GrayImage& cells, Cell seed);

}  // namespace lapis::simulator
