#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// What the simulator knows of a run's scene, in the run's map frame.
struct GroundTruth {
  KnownSpace
      mesh;  ///< of mesh.lapis: labelled surface in line of sight; with the free voxels, all that can be explored
  /// Of with_margin.lapis: the same for a robot that keeps its planner's margin; none in older folders.
  std::optional<KnownSpace> with_margin;
  std::vector<std::uint16_t> top_classes;  ///< of classes.json: the classes that runs in this scene are judged by
  geometry::Pose T_map_world;              ///< of rooms.json
};

/// Reads mesh.lapis, with_margin.lapis, classes.json and rooms.json of a folder. Nothing when one of them is not there,
/// with the reason in `problem` when mesh.lapis is, or when a file is damaged.
std::optional<GroundTruth> load_ground_truth(const std::filesystem::path& folder, std::string& problem);

/// True when two transforms into the map differ so little that their voxel grids coincide: by 10 mm and 1 mrad.
bool is_same_frame(const geometry::Pose& T_map_world, const geometry::Pose& other);

}  // namespace lapis::evaluator
