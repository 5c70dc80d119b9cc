#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/scene/scene.hpp"
#include "simulator/core/truth/voxel_box.hpp"

namespace lapis::simulator {

/// A surface nearer to a voxel than this is in it [voxels]: one that lies in the face between two voxels is in both, as
/// it is in the map of a camera with the least noise. The floor is such a surface: it is at z = 0 of the map.
inline constexpr double kTouch = 0.004;
/// Voxels with less surface are empty [faces of a voxel]: a camera hardly meets it.
inline constexpr double kLeastArea = 0.01;

/// A voxel that surface of the mesh passes through.
struct SurfaceVoxel {
  std::size_t cell = 0;     ///< in the box
  std::uint16_t label = 0;  ///< class with the largest area in the voxel, ties to the smaller id; 0: none has a class
  bool operator==(const SurfaceVoxel&) const = default;
};

/// Box of the scene's mesh and of the places (world frame [m]) that it is seen from, in the map frame.
VoxelBox voxel_box(const Scene& scene, const geometry::Pose& T_map_world, double resolution_m,
                   const std::vector<Eigen::Vector3d>& eyes = {});

/// Surface voxels of the scene's mesh, sorted by cell. Areas are exact: every triangle is cut at the voxels' faces.
/// Holes of cut-out textures count as surface. The mesh must be sound (problem_of) and lie in the box.
/// @throws std::runtime_error in one line with the remedy when its surface is too large for that resolution.
std::vector<SurfaceVoxel> surface_voxels(const Scene& scene, const geometry::Pose& T_map_world, const VoxelBox& box);

}  // namespace lapis::simulator
