#include "evaluator/core/map/nearest_voxel.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace lapis::evaluator {
namespace {

// Ranges up to this size are scanned, which is faster than descending further.
constexpr std::size_t kLeafSize = 8;

std::int64_t squared(const VoxelIndex& d) { return d.cast<std::int64_t>().squaredNorm(); }

}  // namespace

NearestVoxel::NearestVoxel(std::vector<VoxelIndex> voxels) : voxels_(std::move(voxels)) {
  if (voxels_.empty()) throw std::invalid_argument("nearest-voxel search needs at least one voxel");
  build(0, voxels_.size(), 0);
}

void NearestVoxel::build(std::size_t begin, std::size_t end, int axis) {
  if (end - begin <= kLeafSize) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t i) { return voxels_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const VoxelIndex& a, const VoxelIndex& b) { return a[axis] < b[axis]; });
  build(begin, middle, (axis + 1) % 3);
  build(middle + 1, end, (axis + 1) % 3);
}

std::int64_t NearestVoxel::squared_distance(const VoxelIndex& query) const {
  std::int64_t best = std::numeric_limits<std::int64_t>::max();
  search(query, 0, voxels_.size(), 0, best);
  return best;
}

void NearestVoxel::search(const VoxelIndex& query, std::size_t begin, std::size_t end, int axis,
                          std::int64_t& best) const {
  if (end - begin <= kLeafSize) {
    for (std::size_t i = begin; i < end; ++i) best = std::min(best, squared(voxels_[i] - query));
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  best = std::min(best, squared(voxels_[middle] - query));
  const std::int64_t offset = std::int64_t{query[axis]} - voxels_[middle][axis];
  const bool is_left_first = offset < 0;
  const int next = (axis + 1) % 3;
  if (is_left_first) {
    search(query, begin, middle, next, best);
  } else {
    search(query, middle + 1, end, next, best);
  }
  if (offset * offset >= best) return;
  if (is_left_first) {
    search(query, middle + 1, end, next, best);
  } else {
    search(query, begin, middle, next, best);
  }
}

}  // namespace lapis::evaluator
