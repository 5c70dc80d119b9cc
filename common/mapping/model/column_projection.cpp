#include "common/mapping/model/column_projection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lapis::mapping {
namespace {

void project_block(const VoxelBlock& block, const BlockIndex& index, double resolution_m, const BeliefReader& reader,
                   const HeightBand& band, ColumnCells& cells) {
  VoxelCounts counts;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (!is_in_band(voxel_at(index, offset).z, resolution_m, band)) continue;
    block.read(offset, counts);
    if (!counts.is_observed()) continue;
    std::int8_t& cell = cells[static_cast<std::size_t>(offset) % cells.size()];
    cell = std::max(cell, reader.is_occupied(counts) ? kOccupied : kFree);
  }
}

}  // namespace

bool is_in_band(std::int32_t z, double resolution_m, const HeightBand& band) {
  const double center_m = (z + 0.5) * resolution_m;
  return center_m >= band.min_height_m && center_m < band.max_height_m;
}

ColumnCells project_column(const BlockColumn& column, const VoxelMap& map, const BeliefReader& reader,
                           const HeightBand& band) {
  ColumnCells cells;
  cells.fill(kUnknown);
  const auto block_layer = [&](double height_m) {
    return static_cast<std::int32_t>(std::floor(height_m / (map.resolution_m() * kBlockEdge)));
  };
  const std::int32_t last = block_layer(band.max_height_m);
  for (std::int32_t z = block_layer(band.min_height_m); z <= last; ++z) {
    const BlockIndex index{column.x, column.y, z};
    if (const VoxelBlock* block = map.find(index))
      project_block(*block, index, map.resolution_m(), reader, band, cells);
  }
  return cells;
}

}  // namespace lapis::mapping
