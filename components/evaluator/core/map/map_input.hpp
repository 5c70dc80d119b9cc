#pragma once

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// What a semantic map knows: every observed voxel, occupied where P(occupied) > 0.5 and free elsewhere, with the most
/// probable class. Throws std::invalid_argument for a voxel beyond kMaxVoxelIndex.
KnownSpace to_known_space(const mapping::VoxelMap& map, const mapping::BeliefReader& beliefs);

}  // namespace lapis::evaluator
