#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// Ground truth of a run's scene from the simulator, in the run's map frame.
struct GroundTruth {
  /// From mesh.lapis: the labelled surface in line of sight; together with the free voxels, all that can be explored.
  KnownSpace mesh;
  /// From with_margin.lapis: the same for a robot that keeps its planner's margin; empty in older folders.
  std::optional<KnownSpace> with_margin;
  std::vector<std::uint16_t> top_classes;  ///< from classes.json: the classes by which runs in this scene are judged
  geometry::Pose T_map_world;              ///< from rooms.json
};

/// Reads mesh.lapis, classes.json, rooms.json and, if it exists, with_margin.lapis of a folder. Returns nothing when
/// mesh.lapis does not exist, and, with the reason in `problem`, when another file is missing or a file is damaged.
std::optional<GroundTruth> load_ground_truth(const std::filesystem::path& folder, std::string& problem);

/// True when two transforms into the map frame differ so little that their voxel grids coincide: by at most 10 mm and 1
/// mrad.
bool is_same_frame(const geometry::Pose& T_map_world, const geometry::Pose& other);

}  // namespace lapis::evaluator
