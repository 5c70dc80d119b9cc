#include "evaluator/core/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lapis::evaluator {
namespace {

std::vector<VoxelIndex> known_voxels(const KnownSpace& map) {
  std::vector<VoxelIndex> occupied;
  for (const LabelledVoxel& voxel : map.occupied.voxels) occupied.push_back(voxel.index);
  std::vector<VoxelIndex> known;
  std::merge(occupied.begin(), occupied.end(), map.free.begin(), map.free.end(), std::back_inserter(known), is_before);
  return known;
}

}  // namespace

Coverage coverage(const KnownSpace& map) {
  const double voxel_m3 = std::pow(map.occupied.resolution_m, 3);
  Coverage result;
  result.free_volume_m3 = static_cast<double>(map.free.size()) * voxel_m3;
  result.occupied_volume_m3 = static_cast<double>(map.occupied.voxels.size()) * voxel_m3;
  result.explored_volume_m3 = static_cast<double>(map.free.size() + map.occupied.voxels.size()) * voxel_m3;
  return result;
}

Coverage coverage(const KnownSpace& reference, const KnownSpace& map) {
  require_same_grid(reference.occupied, map.occupied);
  Coverage result = coverage(map);
  const auto wanted = known_voxels(reference);
  const auto known = known_voxels(map);
  std::vector<VoxelIndex> common;
  std::set_intersection(wanted.begin(), wanted.end(), known.begin(), known.end(), std::back_inserter(common),
                        is_before);
  if (!wanted.empty()) {
    result.explored_share = static_cast<double>(common.size()) / static_cast<double>(wanted.size());
  }
  return result;
}

std::optional<double> time_to_reach(const std::vector<ShareAt>& rows, double share) {
  const auto first = std::find_if(rows.begin(), rows.end(), [share](const ShareAt& row) { return row.share >= share; });
  return first == rows.end() ? std::nullopt : std::optional(first->time_s);
}

}  // namespace lapis::evaluator
