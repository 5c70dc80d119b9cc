#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mapping/model/column_projection.hpp"

namespace lapis::semantic_mapper {

using mapping::kFree, mapping::kOccupied, mapping::kUnknown;

/// Grid in the map frame. Cell (column, row) covers [x, x + resolution_m) from x = origin_x_m + column * resolution_m,
/// and the same in y with origin_y_m and row.
struct OccupancyGrid {
  double resolution_m = 0.0;
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  int width = 0;                   ///< columns, along x
  int height = 0;                  ///< rows, along y
  std::vector<std::int8_t> cells;  ///< row by row: kOccupied, kFree, kUnknown

  bool operator==(const OccupancyGrid&) const = default;
};

/// State of a column of voxels.
struct GridCell {
  std::int32_t x = 0;  ///< as VoxelIndex
  std::int32_t y = 0;
  std::int8_t value = kUnknown;
};

/// The smallest grid that holds all cells; of several cells at one place, the largest value counts.
OccupancyGrid make_grid(std::span<const GridCell> cells, double resolution_m);

}  // namespace lapis::semantic_mapper
