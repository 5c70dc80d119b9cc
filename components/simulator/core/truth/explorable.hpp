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

/// Places (world frame [m]) that represent all those that the robot's centre can reach: for each square of edge
/// `spacing_m`, the reachable cell nearest to its middle; none when the robot does not fit at the start.
std::vector<Eigen::Vector2d> viewpoints(const NavMap& map, const Eigen::Vector2d& start, double radius_m,
                                        double spacing_m);

/// The angles above the horizon at which the pixels of a camera look.
struct ElevationRange {
  double low_rad = 0.0, high_rad = 0.0;
};

/// The range of a camera without roll that looks `pitch_down_rad` below the horizon.
ElevationRange elevation_range(const geometry::PinholeCamera& camera, double pitch_down_rad);

struct VisibilityConfig {
  ElevationRange elevation;     ///< the camera turns to any heading
  double range_m = 5.0;         ///< Euclidean
  int threads = 1;              ///< the result does not depend on it
  std::stop_token cancelled{};  ///< after a request to stop, the result comes soon and is incomplete
};

/// Voxels that a camera at one of `positions` (world frame [m]) has in line of sight: those through which a ray passes,
/// and those in which it hits a surface. Rays are so dense that a voxel at the end of the range is one ray wide. A ray
/// that hits nothing, not even beyond the range, does not count, like a pixel without depth. The mesh must be in the
/// box.
/// @throws std::invalid_argument when a position is outside the box.
VoxelSet visible_voxels(const SceneRaycaster& raycaster, const std::vector<Eigen::Vector3d>& positions,
                        const VisibilityConfig& config, const geometry::Pose& T_map_world, const VoxelBox& box);

/// Voxels that are not solid and are connected through faces, within the box, to one of the seeds (world frame [m]),
/// and the solid ones next to them (26 neighbours).
VoxelSet flooded_voxels(const VoxelSet& solid, const std::vector<Eigen::Vector3d>& seeds,
                        const geometry::Pose& T_map_world, const VoxelBox& box);

}  // namespace lapis::simulator
