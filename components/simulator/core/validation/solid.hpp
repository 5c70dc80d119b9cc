#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

/// The space that an item fills, in voxels of a grid that all items share: those through which its surface passes, and
/// those that cannot be reached from beside or above it without passing through the former.
class Solid {
 public:
  static constexpr float kVoxel_m = 0.02F;

  Solid(const Scene& scene, const Item& item);

  /// Greatest number of voxels that the box of an item takes.
  static double voxels(const Item& item);

  const Eigen::Vector3i& low() const { return low_; }                  ///< lowest voxel
  Eigen::Vector3i high() const { return (low_ + size_).array() - 1; }  ///< highest voxel
  std::size_t count() const { return count_; }
  bool contains(const Eigen::Vector3i& voxel) const {
    const Eigen::Vector3i v = voxel - low_;
    return is_in_box(v) && filled_[index(v)] != 0;
  }

 private:
  bool is_in_box(const Eigen::Vector3i& v) const { return (v.array() >= 0).all() && (v.array() < size_.array()).all(); }
  std::size_t index(const Eigen::Vector3i& v) const {
    return (static_cast<std::size_t>(v.z()) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(v.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(v.x());
  }
  void fill_inside();

  Eigen::Vector3i low_, size_;
  std::vector<std::uint8_t> filled_;
  std::size_t count_ = 0;
};

}  // namespace lapis::simulator
