#pragma once

#include <cstdint>
#include <vector>

#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// Exact nearest-neighbour search among voxels: a balanced k-d tree stored in one array, integer distances.
class NearestVoxel {
 public:
  /// Takes a copy, which it reorders. Throws std::invalid_argument when there are no voxels.
  explicit NearestVoxel(std::vector<VoxelIndex> voxels);

  /// Squared distance [voxels^2] from `query` to the nearest voxel.
  std::int64_t squared_distance(const VoxelIndex& query) const;

 private:
  void build(std::size_t begin, std::size_t end, int axis);
  void search(const VoxelIndex& query, std::size_t begin, std::size_t end, int axis, std::int64_t& best) const;

  std::vector<VoxelIndex> voxels_;
};

}  // namespace lapis::evaluator
