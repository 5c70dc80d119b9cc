#include "evaluator/core/map/map_input.hpp"

namespace lapis::evaluator {

KnownSpace to_known_space(const mapping::VoxelMap& map, const mapping::BeliefReader& beliefs) {
  std::vector<LabelledVoxel> occupied;
  std::vector<VoxelIndex> free;
  map.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    const VoxelIndex index(voxel.x, voxel.y, voxel.z);
    if (beliefs.is_occupied(counts)) {
      occupied.push_back({index, beliefs.label(counts)});
    } else {
      free.push_back(index);
    }
  });
  return make_known_space(make_labelled_voxels(map.resolution_m(), std::move(occupied)), std::move(free));
}

}  // namespace lapis::evaluator
