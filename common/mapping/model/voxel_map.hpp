#pragma once

#include <cstddef>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/model/voxel_block.hpp"
#include "common/mapping/model/voxel_index.hpp"

namespace lapis::mapping {

/// Smallest and largest edge of a voxel that the formats and algorithms support [m].
inline constexpr double kMinResolution_m = 0.02;
inline constexpr double kMaxResolution_m = 0.5;

/// Semantic voxel map: for each voxel, the number of frames that saw through it (misses) and, per class, the number of
/// frames that saw a surface in it (hits). Log-odds updates are additive (eq. 11 of the paper), so these counts are
/// sufficient; BeliefReader converts them to probabilities with a SensorModel. Integer counts do not depend on the
/// order of frames, and a frame can be subtracted again exactly. A voxel that was never observed is unknown. The world
/// is assumed to be static.
class VoxelMap {
 public:
  /// @param resolution_m edge of a voxel, in [0.02, 0.5] m; throws std::runtime_error outside this range
  explicit VoxelMap(double resolution_m);

  double resolution_m() const { return resolution_m_; }
  /// Voxel that contains a point of the map frame [m].
  VoxelIndex index_of(const Eigen::Vector3d& p_map) const;
  /// Centre of a voxel in the map frame [m].
  Eigen::Vector3d center_of(const VoxelIndex& voxel) const;

  void add(const FrameVotes& votes);
  /// Exact inverse of add. Throws std::logic_error when the votes were never added (a bug of the caller).
  void subtract(const FrameVotes& votes);

  /// Null when no voxel of the block was ever observed.
  const VoxelBlock* find(const BlockIndex& block) const;
  VoxelCounts read(const VoxelIndex& voxel) const;
  /// Replaces a block; an empty one is removed.
  void set_block(const BlockIndex& index, VoxelBlock block);
  void erase_block(const BlockIndex& index) { blocks_.erase(index); }

  std::size_t block_count() const { return blocks_.size(); }
  /// Indices of all blocks in the canonical order (z, y, x).
  std::vector<BlockIndex> sorted_blocks() const;
  /// Calls visit(VoxelIndex, const VoxelCounts&) for every observed voxel, blocks in canonical order.
  template <class Visitor>
  void for_each_observed(Visitor&& visit) const;

  /// Memory of the blocks [bytes].
  std::size_t bytes() const;
  /// True for equal content at equal resolution, whatever the history.
  bool operator==(const VoxelMap& other) const;

 private:
  double resolution_m_;
  std::unordered_map<BlockIndex, VoxelBlock, GridIndexHash> blocks_;  ///< never holds an empty block
};

template <class Visitor>
void VoxelMap::for_each_observed(Visitor&& visit) const {
  VoxelCounts counts;
  for (const BlockIndex& index : sorted_blocks()) {
    const VoxelBlock& block = blocks_.at(index);
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      block.read(offset, counts);
      if (counts.is_observed()) visit(voxel_at(index, offset), static_cast<const VoxelCounts&>(counts));
    }
  }
}

}  // namespace lapis::mapping
