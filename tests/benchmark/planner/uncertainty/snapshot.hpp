#pragma once

#include <cstdint>
#include <map>

#include "common/geometry/se3.hpp"
#include "semantic_mapper/core/map_stakes.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::planner::benchmark {

/// The share of a map's evidence, weighted by stakes, that is still in its voxels.
struct Survival {
  double voxels = 0.0;          ///< all stakes [voxels]
  double actual = 0.0;          ///< by the errors of the key-frames
  double predicted = 0.0;       ///< by the graph's marginals
  double predicted_wide = 0.0;  ///< the same, every sigma times kWideFactor
  double ate_m = 0.0;           ///< root mean square of the positions' errors, without alignment
  double sigma_m = 0.0;         ///< the same as predicted, along one axis
};

/// Chosen before any run of the calibration buildings.
inline constexpr double kWideFactor = 1.3;

/// @param truth T_map_camera of the graph's key-frames
/// @throws std::runtime_error when the graph cannot be analysed
Survival survival_of(const slam::PoseGraphSnapshot& graph, const std::map<std::uint64_t, geometry::Pose>& truth,
                     const std::map<std::uint64_t, semantic_mapper::Stake>& stakes, double resolution_m);

/// By the maps themselves: for each occupied voxel of `map`, the part of its hits that the map of the same frames at
/// their true poses has there, too; the mean.
double common_share(const mapping::VoxelMap& map, const mapping::VoxelMap& at_true_poses);

}  // namespace lapis::planner::benchmark
