#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>

#include "common/mapping/model/column_projection.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"

namespace lapis::semantic_mapper {

/// Projection of a map onto the ground (column_projection.hpp). Only columns of blocks that were marked since the last
/// projection are projected again.
class FloorPlan {
 public:
  explicit FloorPlan(const mapping::HeightBand& band) : band_(band) {}

  /// Marks blocks whose content may have changed.
  void mark_changed(std::span<const mapping::BlockIndex> blocks);
  /// The plan of `map`, equal to that of a new FloorPlan provided that all changes were marked. The first time, and
  /// when the sensor model is not that of the last time, everything is projected.
  OccupancyGrid project(const mapping::VoxelMap& map, const mapping::BeliefReader& reader);

 private:
  void mark_all(const mapping::VoxelMap& map);

  mapping::HeightBand band_;
  std::map<mapping::BlockColumn, mapping::ColumnCells> columns_;  ///< only those with a known cell
  std::set<mapping::BlockColumn> changed_;
  std::optional<mapping::SensorModel> model_;  ///< of the last projection
};

}  // namespace lapis::semantic_mapper
