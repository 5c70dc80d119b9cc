#include "simulator/core/truth/voxel_box.hpp"

#include <bit>
#include <sstream>
#include <stdexcept>

namespace lapis::simulator {
namespace {

constexpr double kMaxCells = 2e8;  // memory: one bit each in several sets, and 8 bytes for each known cell

}  // namespace

VoxelBox::VoxelBox(const Eigen::AlignedBox3d& box, double resolution_m) : resolution_m_(resolution_m) {
  const Eigen::Vector3d low = (box.min() / resolution_m).array().floor() - 1.0;
  const Eigen::Vector3d edges = (box.max() / resolution_m).array().floor() + 2.0 - low.array();
  if (box.isEmpty() || !(edges.prod() <= kMaxCells)) {
    std::ostringstream problem;
    problem << "the scene measures " << box.sizes().transpose() << " m, too much for voxels of " << resolution_m
            << " m; take larger voxels, or correct its units if they are not metres";
    throw std::runtime_error(problem.str());
  }
  low_ = low.cast<int>();
  edges_ = edges.cast<int>();
  const auto width = static_cast<std::size_t>(edges_.x());
  strides_ = {1, width, width * static_cast<std::size_t>(edges_.y())};
}

Eigen::Vector3i VoxelBox::offset_of(std::size_t cell) const {
  return {static_cast<int>(cell % strides_.y()), static_cast<int>(cell % strides_.z() / strides_.y()),
          static_cast<int>(cell / strides_.z())};
}

mapping::VoxelIndex VoxelBox::index_of(std::size_t cell) const {
  const Eigen::Vector3i v = low_ + offset_of(cell);
  return {v.x(), v.y(), v.z()};
}

void VoxelSet::insert(const VoxelSet& other) {
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
}

std::size_t VoxelSet::count() const {
  std::size_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
  return sum;
}

std::vector<std::size_t> VoxelSet::cells() const {
  std::vector<std::size_t> cells;
  for (std::size_t i = 0; i < words_.size(); ++i) {
    for (std::uint64_t bits = words_[i]; bits != 0; bits &= bits - 1) {
      cells.push_back(i * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }
  return cells;
}

}  // namespace lapis::simulator
