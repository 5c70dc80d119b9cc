#pragma once

#include <stop_token>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/truth/voxel_box.hpp"

namespace lapis::simulator {

/// Places that stand for all that the robot's centre can get to: of each square of edge `spacing_m`, the reachable cell
/// nearest to its middle. World frame. None when it does not fit at the start.
std::vector<Eigen::Vector2d> viewpoints(const NavMap& map, const Eigen::Vector2d& start, double radius_m,
                                        double spacing_m);

/// Angles above the horizon that some pixel of a camera looks at.
struct ElevationRange {
  double low_rad = 0.0, high_rad = 0.0;
};

/// Of a camera that is level sidewards and looks `pitch_down_rad` below the horizon.
ElevationRange elevation_range(const geometry::PinholeCamera& camera, double pitch_down_rad);

struct VisibilityConfig {
  ElevationRange elevation;     ///< the camera turns to any heading
  double range_m = 5.0;         ///< Euclidean
  int threads = 1;              ///< the result does not depend on it
  std::stop_token cancelled{};  ///< once asked to stop, the result is worthless and comes soon
};

/// Voxels that a camera at one of `positions` (world frame [m]) has in line of sight: those that a ray passes through
/// or meets a surface in. Rays are so dense that a voxel at the end of the range is one ray wide. A ray that meets
/// nothing at all, be it beyond the range, says nothing, like a pixel without depth. The mesh must lie in the box.
/// @throws std::invalid_argument when a position lies outside of the box.
VoxelSet visible_voxels(const SceneRaycaster& raycaster, const std::vector<Eigen::Vector3d>& positions,
                        const VisibilityConfig& config, const geometry::Pose& T_map_world, const VoxelBox& box);

/// Voxels that are not solid and joined, by steps over faces, to one of the seeds (world frame [m]) within the box; and
/// solid ones next to them (26 neighbours).
VoxelSet flooded_voxels(const VoxelSet& solid, const std::vector<Eigen::Vector3d>& seeds,
                        const geometry::Pose& T_map_world, const VoxelBox& box);

}  // namespace lapis::simulator
