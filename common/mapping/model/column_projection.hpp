#pragma once

#include <array>
#include <compare>
#include <cstdint>

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::mapping {

/// The range of heights (z of the map frame) in which the robot can collide with something.
struct HeightBand {
  double min_height_m = 0.2;  ///< voxels whose centre is lower are ignored; choose it above the floor
  double max_height_m = 1.2;  ///< voxels whose centre is at or above are ignored; choose it above the robot's top
};

/// True when the centre of the voxels of layer `z` lies in [min_height_m, max_height_m).
bool is_in_band(std::int32_t z, double resolution_m, const HeightBand& band);

/// Values of a cell of a floor plan, as in nav_msgs/OccupancyGrid.
inline constexpr std::int8_t kOccupied = 100, kFree = 0, kUnknown = -1;

/// All blocks with the same x and y, one above the other.
struct BlockColumn {
  std::int32_t x = 0;
  std::int32_t y = 0;
  auto operator<=>(const BlockColumn&) const = default;
};

/// Cells of a block column; cell (x, y) has index x + 8 y.
using ColumnCells = std::array<std::int8_t, kBlockEdge * kBlockEdge>;

/// Projects the voxels of the band onto the ground. A cell is occupied if any voxel above it is occupied (P > 0.5),
/// otherwise free if any of these voxels is observed, otherwise unknown.
ColumnCells project_column(const BlockColumn& column, const VoxelMap& map, const BeliefReader& reader,
                           const HeightBand& band);

}  // namespace lapis::mapping
