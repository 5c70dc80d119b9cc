#include "semantic_mapper/core/floor_plan.hpp"

#include <algorithm>
#include <vector>

namespace lapis::semantic_mapper {

using mapping::BlockIndex;
using mapping::kBlockEdge;

void FloorPlan::mark_changed(std::span<const BlockIndex> blocks) {
  for (const BlockIndex& block : blocks) changed_.insert({block.x, block.y});
}

void FloorPlan::mark_all(const mapping::VoxelMap& map) {
  columns_.clear();
  mark_changed(map.sorted_blocks());
}

OccupancyGrid FloorPlan::project(const mapping::VoxelMap& map, const mapping::BeliefReader& reader) {
  if (model_ != reader.model()) mark_all(map);
  model_ = reader.model();
  for (const mapping::BlockColumn& column : changed_) {
    const mapping::ColumnCells cells = mapping::project_column(column, map, reader, band_);
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
        known.push_back({column.x * kBlockEdge + i % kBlockEdge, column.y * kBlockEdge + i / kBlockEdge, value});
  return make_grid(known, map.resolution_m());
}

}  // namespace lapis::semantic_mapper
