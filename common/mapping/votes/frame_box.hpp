#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "common/mapping/model/voxel_index.hpp"

namespace lapis::mapping {

/// Cells of the frame's box are numbered block by block (512 per block), so that ascending ids have the order of
/// FrameVotes.
using CellId = std::uint32_t;

/// Box of whole blocks, in voxels of the map, that holds everything the frame can reach.
class FrameBox {
 public:
  FrameBox(const Eigen::Vector3d& low_voxels, const Eigen::Vector3d& high_voxels, int margin_voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto first = static_cast<std::int32_t>(std::floor(low_voxels[axis])) - margin_voxels;
      const auto last = static_cast<std::int32_t>(std::floor(high_voxels[axis])) + margin_voxels;
      first_block_[axis] = floor_divide(first, kBlockEdge);
      blocks_[axis] = floor_divide(last, kBlockEdge) - first_block_[axis] + 1;
    }
  }

  /// Corner of the box [voxels of the map].
  Eigen::Vector3d origin() const { return (first_block_ * kBlockEdge).cast<double>(); }
  Eigen::Vector3i blocks() const { return blocks_; }
  std::size_t block_count() const { return static_cast<std::size_t>(blocks_.prod()); }
  /// Id of the cell with these coordinates in the box.
  CellId id(unsigned x, unsigned y, unsigned z) const {
    const auto columns = static_cast<unsigned>(blocks_[0]), rows = static_cast<unsigned>(blocks_[1]);
    const unsigned block = ((z >> 3) * rows + (y >> 3)) * columns + (x >> 3);
    return block << 9 | (z & 7u) << 6 | (y & 7u) << 3 | (x & 7u);
  }
  BlockIndex block(const Eigen::Vector3i& b) const {
    return {first_block_[0] + b[0], first_block_[1] + b[1], first_block_[2] + b[2]};
  }

 private:
  Eigen::Vector3i first_block_;
  Eigen::Vector3i blocks_;
};

}  // namespace lapis::mapping
