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
  /// `memory` holds the marks; it is resized and cleared, and must outlive this object.
  RayMarks(const FrameBox& box, std::vector<std::uint8_t>& memory);

  /// Marks every cell that the segment from `start` along `ray` [voxels] leaves before the share `t_end` of its length
  /// [Amanatides & Woo 1987].
  void add_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double t_end);
  /// Clears the marks of all cells within `margin` of the cell in which the segment from `start` along `ray` ends
  /// [voxels]. Cells farther than `reach` from the start are skipped, because no ray marks them.
  void clear_around(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double margin, double reach);
  /// Marks of the 64 cells of layer `layer` (0 to 7) of the block at position `block` in the box, as bits x + 8 y.
  std::uint64_t layer_bits(const Eigen::Vector3i& block, int layer) const;

 private:
  std::uint8_t* cells_;
  std::array<std::ptrdiff_t, 3> pitch_;
  Eigen::Array3i last_;  // coordinates of the last cell
};

}  // namespace lapis::mapping
