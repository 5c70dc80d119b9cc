#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lapis::evaluator {

/// Cell (x, y, z) of a grid in the map frame: it spans [index, index + 1) * resolution on each axis.
using VoxelIndex = Eigen::Vector3i;

/// Indices stay within +-2^20, so that squared distances and packed keys fit 64 bits.
inline constexpr int kMaxVoxelIndex = (1 << 20) - 1;

/// Order by x, then y, then z.
bool is_before(const VoxelIndex& a, const VoxelIndex& b);

struct LabelledVoxel {
  VoxelIndex index = VoxelIndex::Zero();
  std::uint16_t label = 0;  ///< most probable class; 0 = unlabelled
  bool operator==(const LabelledVoxel&) const = default;
};

/// Occupied voxels of a map, sorted by index, each once.
struct LabelledVoxels {
  double resolution_m = 0.0;  ///< edge of a voxel
  std::vector<LabelledVoxel> voxels;
};

/// The observed space of a map. `free` is sorted and contains each voxel once, none of them occupied.
struct KnownSpace {
  LabelledVoxels occupied;
  std::vector<VoxelIndex> free;
};

/// Sorts and checks the voxels. Throws std::invalid_argument when the resolution is not positive, or when a voxel
/// occurs twice or is beyond kMaxVoxelIndex.
LabelledVoxels make_labelled_voxels(double resolution_m, std::vector<LabelledVoxel> voxels);
/// Sorts and checks the voxels, as above; also throws when a voxel is both free and occupied.
KnownSpace make_known_space(LabelledVoxels occupied, std::vector<VoxelIndex> free);

/// Throws std::invalid_argument, which names both resolutions, when they differ, because then the grids do not
/// coincide.
void require_same_grid(const LabelledVoxels& reference, const LabelledVoxels& estimate);

}  // namespace lapis::evaluator
