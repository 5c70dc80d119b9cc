#pragma once

#include "common/geometry/se3.hpp"
#include "common/mapping/file/map_file.hpp"

namespace lapis::semantic_mapper {

/// True when the transform maps voxels onto voxels: quarter turns and whole numbers of voxels (to 1e-6).
bool is_on_grid(const geometry::Pose& T, double resolution_m);

/// Adds the counts of `other` to those of `sum`. A voxel of `sum` gets the counts of the one voxel of `other` that
/// contains its centre. On the grid this is exact: merging maps equals building one map from all frames. Elsewhere it
/// is nearest-neighbour resampling: surfaces move by up to half the diagonal of a voxel, and a voxel of `other` may be
/// used twice or not at all. Classes are united; the sensor model stays that of `sum`, except for the number of
/// classes. The sum keeps its frame settings only when both maps have the same ones.
/// @param T_map_other pose of the frame of `other` in that of `sum`
/// Throws std::runtime_error, before anything is changed, when resolutions or prior shares of the classes differ, only
/// one map is fused by bki, a class id has two names, or a count would not fit 32 bits.
void merge_into(mapping::MapFile& sum, const mapping::MapFile& other, const geometry::Pose& T_map_other);

}  // namespace lapis::semantic_mapper
