#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/votes/frame_box.hpp"

namespace lapis::mapping {

/// One byte per cell of the box, x fastest; not zero where a ray gives a miss.
class RayMarks {
 public:
  /// `memory` holds the marks, and is cleared.
  RayMarks(const FrameBox& box, std::vector<std::uint8_t>& memory);

  /// Marks every cell that the segment from `start` along `ray` [voxels] leaves before the share `t_end` of its length
  /// [Amanatides & Woo 1987].
  void add_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double t_end);
  /// Takes the marks off the cells within `margin` of the one in which the segment from `start` along `ray` ends; only
  /// those matter that are within `reach` of the start.
  void clear_around(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double margin, double reach);
  /// The 64 cells of a layer, from 0 to 7, of the block at `block` of the box, as bits.
  std::uint64_t layer_bits(const Eigen::Vector3i& block, int layer) const;

 private:
  std::uint8_t* cells_;
  std::array<std::ptrdiff_t, 3> pitch_;
  Eigen::Array3i last_;  // coordinates of the last cell
};

}  // namespace lapis::mapping
