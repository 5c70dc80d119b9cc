#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "common/mapping/sensor_model.hpp"
#include "common/mapping/voxel_map.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"

namespace lapis::semantic_mapper {

/// Projection of a map onto the ground. Of the voxels of the band (GridConfig), a column with any occupied voxel
/// (P > 0.5) is occupied; otherwise one with any observed voxel is free; otherwise it is unknown. Only columns of
/// blocks that were named since the last projection are looked at again.
class FloorPlan {
 public:
  explicit FloorPlan(const GridConfig& config) : config_(config) {}

  /// The content of these blocks may have changed.
  void mark_changed(std::span<const mapping::BlockIndex> blocks);
  /// The plan of `map`, equal to that of a new FloorPlan provided that all changes were marked. With another sensor
  /// model than the last time everything is projected again, and so it is the first time.
  OccupancyGrid project(const mapping::VoxelMap& map, const mapping::BeliefReader& reader);

 private:
  using Column = std::pair<std::int32_t, std::int32_t>;  // x and y of blocks
  using Cells = std::array<std::int8_t, mapping::kBlockEdge * mapping::kBlockEdge>;

  void mark_all(const mapping::VoxelMap& map);
  Cells project_column(const Column& column, const mapping::VoxelMap& map, const mapping::BeliefReader& reader) const;
  void project_block(const mapping::VoxelBlock& block, const mapping::BlockIndex& index, double resolution_m,
                     const mapping::BeliefReader& reader, Cells& cells) const;

  GridConfig config_;
  std::map<Column, Cells> columns_;  ///< with at least one cell that is known
  std::set<Column> changed_;
  std::optional<mapping::SensorModel> model_;  ///< of the last projection
};

}  // namespace lapis::semantic_mapper
