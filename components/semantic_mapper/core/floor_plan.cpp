#include "semantic_mapper/core/floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lapis::semantic_mapper {

using mapping::BlockIndex;
using mapping::kBlockEdge;

void FloorPlan::mark_changed(std::span<const BlockIndex> blocks) {
  for (const BlockIndex& block : blocks) changed_.emplace(block.x, block.y);
}

void FloorPlan::mark_all(const mapping::VoxelMap& map) {
  columns_.clear();
  mark_changed(map.sorted_blocks());
}

OccupancyGrid FloorPlan::project(const mapping::VoxelMap& map, const mapping::BeliefReader& reader) {
  if (model_ != reader.model()) mark_all(map);
  model_ = reader.model();
  for (const Column& column : changed_) {
    const Cells cells = project_column(column, map, reader);
    if (std::all_of(cells.begin(), cells.end(), [](std::int8_t value) { return value == kUnknown; }))
      columns_.erase(column);
    else
      columns_[column] = cells;
  }
  changed_.clear();
  std::vector<GridCell> known;
  for (const auto& [column, cells] : columns_)
    for (std::int32_t i = 0; i < kBlockEdge * kBlockEdge; ++i)
      if (const std::int8_t value = cells[static_cast<std::size_t>(i)]; value != kUnknown)
        known.push_back(
            {column.first * kBlockEdge + i % kBlockEdge, column.second * kBlockEdge + i / kBlockEdge, value});
  return make_grid(known, map.resolution_m());
}

FloorPlan::Cells FloorPlan::project_column(const Column& column, const mapping::VoxelMap& map,
                                           const mapping::BeliefReader& reader) const {
  Cells cells;
  cells.fill(kUnknown);
  const auto block_layer = [&](double height_m) {
    return static_cast<std::int32_t>(std::floor(height_m / (map.resolution_m() * kBlockEdge)));
  };
  const std::int32_t last = block_layer(config_.max_height_m);
  for (std::int32_t z = block_layer(config_.min_height_m); z <= last; ++z) {
    const BlockIndex index{column.first, column.second, z};
    if (const mapping::VoxelBlock* block = map.find(index))
      project_block(*block, index, map.resolution_m(), reader, cells);
  }
  return cells;
}

void FloorPlan::project_block(const mapping::VoxelBlock& block, const BlockIndex& index, double resolution_m,
                              const mapping::BeliefReader& reader, Cells& cells) const {
  mapping::VoxelCounts counts;
  for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
    if (!is_in_band(mapping::voxel_at(index, offset).z, resolution_m, config_)) continue;
    block.read(offset, counts);
    if (!counts.is_observed()) continue;
    std::int8_t& cell = cells[static_cast<std::size_t>(offset) % cells.size()];
    cell = std::max(cell, reader.is_occupied(counts) ? kOccupied : kFree);
  }
}

}  // namespace lapis::semantic_mapper
