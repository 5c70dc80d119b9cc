#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::planner {

/// What a map has learnt so far: by how much the entropy of all its voxels is below that of voxels never observed
/// [nats]. The gain of a path, once it is driven, is the difference.
class MapInformation {
 public:
  /// Throws std::runtime_error naming the parameter of the sensor model that is out of range.
  explicit MapInformation(const mapping::SensorModel& model);

  /// Of all blocks.
  double nats() const { return nats_; }
  /// @param changed all blocks whose content is not what it was at the last call, those that are gone included
  void update(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);

 private:
  double of(const mapping::VoxelBlock* block) const;
  double entropy(const mapping::VoxelCounts& counts) const;

  mapping::BeliefReader reader_;
  std::vector<double> by_misses_;  ///< entropy of voxels without hits, by whole votes; 0: never observed
  std::unordered_map<mapping::BlockIndex, double, mapping::GridIndexHash> blocks_;
  double nats_ = 0.0;
};

}  // namespace lapis::planner
