#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::planner {

/// The information that a map contains: the difference between the entropy of its voxels before any observation and now
/// [nats]. The gain of a path is the difference between before and after the robot drove it.
class MapInformation {
 public:
  /// Throws std::runtime_error naming the parameter of the sensor model that is out of range.
  explicit MapInformation(const mapping::SensorModel& model);

  /// Information of all blocks [nats].
  double nats() const { return nats_; }
  /// @param changed all blocks whose content has changed since the last call, including removed ones
  void update(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);

 private:
  double of(const mapping::VoxelBlock* block) const;
  double entropy(const mapping::VoxelCounts& counts) const;

  mapping::BeliefReader reader_;
  std::vector<double> by_misses_;  ///< entropy of voxels without hits, by whole votes; [0]: never observed
  std::unordered_map<mapping::BlockIndex, double, mapping::GridIndexHash> blocks_;
  double nats_ = 0.0;
};

}  // namespace lapis::planner
