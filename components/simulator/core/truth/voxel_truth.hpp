#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/file/map_description.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

struct TruthConfig {
  double resolution_m = mapping::kDefaultResolution_m;  ///< edge of a voxel; the mapper's, so that grids coincide
  double sensing_range_m = 5.0;                         ///< Euclidean
  double robot_radius_m = 0.2;                          ///< of the disc that has to fit
  double margin_m = 0.05;                               ///< additional clearance that a planner keeps
  double view_spacing_m = 0.5;                          ///< between the places that represent all reachable ones
  geometry::PinholeCamera camera;                       ///< sees up and down; it turns to any heading
  geometry::CameraMount mount;
  int threads = 1;              ///< the result does not depend on it
  std::stop_token cancelled{};  ///< after a request to stop, the result comes soon and is incomplete
};

/// What can be known of a scene, in the run's frame `map`. Known voxels with surface are occupied and have its class;
/// the other known ones are free.
struct VoxelTruth {
  mapping::VoxelMap mesh;   ///< known: what the mounted camera can see from some reachable place
  mapping::VoxelMap flood;  ///< known: free space that is connected to these places, and the surface next to it
  /// Known: what the camera can see from places that are reached with the margin; empty when the start has no margin.
  mapping::VoxelMap with_margin;
};

/// Transform from the world to the frame `map` of a run, which is base_link at the start, where slam puts the origin of
/// `map`. The evaluator's own fixed transform, from the first estimate and the first true pose, is the same up to
/// rounding: in the first frame, slam's pose of the camera is its mount, T_base_camera, so
/// T_map_camera * T_world_camera^-1 = T_world_base^-1.
inline geometry::Pose T_map_world(const geometry::Pose& T_world_base) { return T_world_base.inverse(); }

/// The three volumes of a scene for a robot that starts at T_world_base. The raycaster is that of the scene's mesh.
/// @throws std::runtime_error when the robot does not fit at the start or the scene is too large for the resolution.
VoxelTruth make_voxel_truth(const Scene& scene, const SceneRaycaster& raycaster, const NavMap& nav_map,
                            const geometry::Pose& T_world_base, const TruthConfig& config);

/// The classes with the most occupied voxels, at most `count`; ties go to the smaller id; "unlabelled" is no class.
std::vector<std::uint16_t> most_frequent_classes(const mapping::VoxelMap& mesh, std::size_t count = 8);

}  // namespace lapis::simulator
