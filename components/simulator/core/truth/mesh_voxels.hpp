#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/scene/scene.hpp"
#include "simulator/core/truth/voxel_box.hpp"

namespace lapis::simulator {

/// A surface that is nearer to a voxel than this counts as in it [voxels]: a surface in the face between two voxels is
/// in both, as in the map of a camera with the least noise. The floor is such a surface: it is at z = 0 of the map.
inline constexpr double kTouch = 0.004;
/// Voxels with less surface than this count as empty [faces of a voxel]: a camera hardly sees it.
inline constexpr double kLeastArea = 0.01;

/// A voxel through which the surface of the mesh passes.
struct SurfaceVoxel {
  std::size_t cell = 0;     ///< in the box
  std::uint16_t label = 0;  ///< class with the largest area in the voxel, ties to the smaller id; 0: none has a class
  bool operator==(const SurfaceVoxel&) const = default;
};

/// Box, in the map frame, of the scene's mesh and of the places (world frame [m]) from which it is seen.
VoxelBox voxel_box(const Scene& scene, const geometry::Pose& T_map_world, double resolution_m,
                   const std::vector<Eigen::Vector3d>& eyes = {});

/// Surface voxels of the scene's mesh, sorted by cell. Areas are exact: every triangle is cut at the voxels' faces.
/// Holes of cut-out textures count as surface. The mesh must be sound (problem_of) and inside the box.
/// @throws std::runtime_error with one line that names the remedy, when its surface is too large for that resolution.
std::vector<SurfaceVoxel> surface_voxels(const Scene& scene, const geometry::Pose& T_map_world, const VoxelBox& box);

}  // namespace lapis::simulator
