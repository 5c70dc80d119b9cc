#include "evaluator/core/map/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lapis::evaluator {
namespace {

std::string to_string(const VoxelIndex& v) {
  return "(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + ")";
}

// Throws std::invalid_argument unless `sorted` contains each voxel once, within bounds.
template <class Voxels, class IndexOf>
void check_sorted(const Voxels& sorted, IndexOf index_of) {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const VoxelIndex& index = index_of(sorted[i]);
    if ((index.array() > kMaxVoxelIndex).any() || (index.array() < -kMaxVoxelIndex).any()) {
      throw std::invalid_argument("voxel " + to_string(index) + " lies outside the grid of +-2^20 voxels");
    }
    if (i > 0 && index_of(sorted[i - 1]) == index) {
      throw std::invalid_argument("voxel " + to_string(index) + " is there twice");
    }
  }
}

}  // namespace

bool is_before(const VoxelIndex& a, const VoxelIndex& b) {
  if (a.x() != b.x()) return a.x() < b.x();
  if (a.y() != b.y()) return a.y() < b.y();
  return a.z() < b.z();
}

LabelledVoxels make_labelled_voxels(double resolution_m, std::vector<LabelledVoxel> voxels) {
  if (!(resolution_m > 0.0) || !std::isfinite(resolution_m)) {
    throw std::invalid_argument("the resolution of a map must be positive");
  }
  std::sort(voxels.begin(), voxels.end(),
            [](const LabelledVoxel& a, const LabelledVoxel& b) { return is_before(a.index, b.index); });
  check_sorted(voxels, [](const LabelledVoxel& voxel) -> const VoxelIndex& { return voxel.index; });
  return {resolution_m, std::move(voxels)};
}

KnownSpace make_known_space(LabelledVoxels occupied, std::vector<VoxelIndex> free) {
  occupied = make_labelled_voxels(occupied.resolution_m, std::move(occupied.voxels));
  std::sort(free.begin(), free.end(), is_before);
  check_sorted(free, [](const VoxelIndex& index) -> const VoxelIndex& { return index; });
  for (const LabelledVoxel& voxel : occupied.voxels) {
    if (std::binary_search(free.begin(), free.end(), voxel.index, is_before)) {
      throw std::invalid_argument("voxel " + to_string(voxel.index) + " is both free and occupied");
    }
  }
  return {std::move(occupied), std::move(free)};
}

void require_same_grid(const LabelledVoxels& reference, const LabelledVoxels& estimate) {
  if (reference.resolution_m == estimate.resolution_m) return;
  throw std::invalid_argument("the reference map has voxels of " + std::to_string(reference.resolution_m) +
                              " m and the estimate of " + std::to_string(estimate.resolution_m) +
                              " m; build both at one resolution");
}

}  // namespace lapis::evaluator
