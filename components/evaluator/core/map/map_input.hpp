#pragma once

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// The known space of a semantic map: every observed voxel, as occupied with its most probable class where P(occupied)
/// > 0.5, and as free elsewhere. Throws std::invalid_argument for a voxel beyond kMaxVoxelIndex.
KnownSpace to_known_space(const mapping::VoxelMap& map, const mapping::BeliefReader& beliefs);

}  // namespace lapis::evaluator
