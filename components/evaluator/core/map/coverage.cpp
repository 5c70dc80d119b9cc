#include "evaluator/core/map/coverage.hpp"

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

void KnownHistory::add(const KnownSpace& map) {
  auto known = known_voxels(map);
  Change change;
  std::set_difference(known.begin(), known.end(), known_.begin(), known_.end(), std::back_inserter(change.added),
                      is_before);
  std::set_difference(known_.begin(), known_.end(), known.begin(), known.end(), std::back_inserter(change.removed),
                      is_before);
  changes_.push_back(std::move(change));
  known_ = std::move(known);
}

std::vector<double> KnownHistory::shares(const KnownSpace& reference) const {
  const auto wanted = known_voxels(reference);
  if (wanted.empty()) return {};
  const auto count_wanted = [&wanted](const std::vector<VoxelIndex>& voxels) {
    return std::count_if(voxels.begin(), voxels.end(), [&wanted](const VoxelIndex& voxel) {
      return std::binary_search(wanted.begin(), wanted.end(), voxel, is_before);
    });
  };
  std::vector<double> shares;
  std::ptrdiff_t common = 0;
  for (const Change& change : changes_) {
    common += count_wanted(change.added) - count_wanted(change.removed);
    shares.push_back(static_cast<double>(common) / static_cast<double>(wanted.size()));
  }
  return shares;
}

}  // namespace lapis::evaluator
