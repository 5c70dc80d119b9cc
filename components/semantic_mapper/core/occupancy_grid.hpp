#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lapis::semantic_mapper {

/// The layer of space in which the robot can run into something.
struct GridConfig {
  double min_height_m = 0.2;  ///< voxels whose centre is below say nothing about the floor plan; above the floor
  double max_height_m = 1.2;  ///< voxels whose centre is at or above say nothing; above the robot's top
};

/// True when the centre of the voxels of layer `z` lies in [min_height_m, max_height_m).
bool is_in_band(std::int32_t z, double resolution_m, const GridConfig& config);

/// Plan in the map frame. Cell (column, row) covers [origin + column * resolution, + resolution) and so on.
struct OccupancyGrid {
  double resolution_m = 0.0;
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  int width = 0;                   ///< columns, along x
  int height = 0;                  ///< rows, along y
  std::vector<std::int8_t> cells;  ///< row by row: kOccupied, kFree, kUnknown
};

inline constexpr std::int8_t kOccupied = 100, kFree = 0, kUnknown = -1;

/// What is known of a column of voxels.
struct GridCell {
  std::int32_t x = 0;  ///< as VoxelIndex
  std::int32_t y = 0;
  std::int8_t value = kUnknown;
};

/// The smallest grid that holds all cells; of several at one place the largest value counts.
OccupancyGrid make_grid(std::span<const GridCell> cells, double resolution_m);

}  // namespace lapis::semantic_mapper
