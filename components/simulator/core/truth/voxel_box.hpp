#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "common/mapping/model/voxel_index.hpp"

namespace lapis::simulator {

/// A box of voxels of the map's grid. A voxel is identified by its cell, which is its number in the box: x first, then
/// y, then z.
class VoxelBox {
 public:
  /// All voxels that the box [m, map frame] touches, and one more on each side.
  /// @throws std::runtime_error with one line that names the remedy, when there are more than 2e8 of them.
  VoxelBox(const Eigen::AlignedBox3d& box, double resolution_m);

  double resolution_m() const { return resolution_m_; }
  Eigen::Vector3d size_m() const { return edges_.cast<double>() * resolution_m_; }
  std::size_t size() const { return strides_.z() * static_cast<std::size_t>(edges_.z()); }
  /// Converts a point of the map frame [m] to voxels from the corner of the box.
  Eigen::Vector3d to_box(const Eigen::Vector3d& p_map) const { return p_map / resolution_m_ - low_.cast<double>(); }
  /// @param v voxels from the corner of the box
  bool contains(const Eigen::Vector3i& v) const { return (v.array() >= 0).all() && (v.array() < edges_.array()).all(); }
  std::size_t cell(const Eigen::Vector3i& v) const { return v.cast<std::size_t>().dot(strides_); }
  /// Inverse of cell.
  Eigen::Vector3i offset_of(std::size_t cell) const;
  mapping::VoxelIndex index_of(std::size_t cell) const;
  /// Increase of the number of a cell for one step along an axis.
  std::ptrdiff_t stride(int axis) const { return static_cast<std::ptrdiff_t>(strides_[axis]); }

 private:
  double resolution_m_;
  Eigen::Vector3i low_, edges_;
  Eigen::Matrix<std::size_t, 3, 1> strides_;
};

/// A set of cells of a box, with one bit per cell.
class VoxelSet {
 public:
  explicit VoxelSet(const VoxelBox& box) : words_(box.size() / 64 + 1) {}

  void insert(std::size_t cell) { words_[cell / 64] |= std::uint64_t{1} << (cell % 64); }
  bool contains(std::size_t cell) const { return (words_[cell / 64] >> (cell % 64) & 1U) != 0; }
  /// Adds all cells of another set of the same box.
  void insert(const VoxelSet& other);
  std::size_t count() const;
  /// Cells in ascending order.
  std::vector<std::size_t> cells() const;
  bool operator==(const VoxelSet&) const = default;

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace lapis::simulator
