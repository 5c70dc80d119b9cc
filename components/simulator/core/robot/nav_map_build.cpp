#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/slab_raster.hpp"

namespace lapis::simulator {
namespace {

constexpr Slab kFloorSlab{-0.1, 0.05};  // relative to the floor's height [m]
constexpr double kLevel = 0.7071;       // least |z| of a floor's unit normal
constexpr int kMargin = 2;              // cells
constexpr double kMaxCells = 4e7;

using Corners = std::array<Eigen::Vector3d, 3>;

bool meets(const Mesh& mesh, const Triangle& triangle, const Slab& slab) {
  const auto a = static_cast<double>(mesh.positions[triangle.vertices[0]].z());
  const auto b = static_cast<double>(mesh.positions[triangle.vertices[1]].z());
  const auto c = static_cast<double>(mesh.positions[triangle.vertices[2]].z());
  return std::min({a, b, c}) <= slab.high && std::max({a, b, c}) >= slab.low;
}

Corners corners_of(const Mesh& mesh, const Triangle& triangle) {
  const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
    return mesh.positions[triangle.vertices[i]].cast<double>();
  };
  return {corner(0), corner(1), corner(2)};
}

bool is_level(const Corners& c) {
  const Eigen::Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  return normal.z() != 0 && std::abs(normal.z()) >= kLevel * normal.norm();
}

std::vector<SlabPolygon> floor_polygons(const Mesh& mesh, const Slab& slab) {
  std::vector<SlabPolygon> floor;
  for (const auto& triangle : mesh.triangles) {
    if (!meets(mesh, triangle, slab)) continue;
    const Corners corners = corners_of(mesh, triangle);
    if (is_level(corners)) floor.push_back(clip(corners, slab));
  }
  return floor;
}

/// The grid over a floor. Its cells begin at multiples of the resolution, so that maps of the same floor coincide.
Grid grid_over(const std::vector<SlabPolygon>& floor, double resolution_m, double floor_z_m) {
  Eigen::AlignedBox2d box;
  for (const auto& polygon : floor) {
    for (std::size_t i = 0; i < polygon.size; ++i) box.extend(polygon.corners[i].head<2>());
  }
  std::ostringstream problem;
  if (box.isEmpty()) {
    problem << "no floor at height " << floor_z_m << " m: give the height of the floor that the robot stands on";
    throw std::runtime_error(problem.str());
  }
  const Eigen::Vector2d low = (box.min() / resolution_m).array().floor() - kMargin;
  const Eigen::Vector2d size = (box.max() / resolution_m).array().floor() + kMargin + 1 - low.array();
  if (size.prod() > kMaxCells) {
    problem << "the floor measures " << box.sizes().x() << " x " << box.sizes().y()
            << " m, too much for a navigation map: are its units metres?";
    throw std::runtime_error(problem.str());
  }
  return {low * resolution_m, resolution_m, static_cast<int>(size.x()), static_cast<int>(size.y())};
}

}  // namespace

NavMap build_nav_map(const Mesh& mesh, double floor_z_m, const NavMapConfig& config, const IsSolid& is_solid) {
  const auto floor = floor_polygons(mesh, {floor_z_m + kFloorSlab.low, floor_z_m + kFloorSlab.high});
  const Grid grid = grid_over(floor, config.resolution_m, floor_z_m);
  geometry::GrayImage has_floor(grid.width, grid.height), blocked(grid.width, grid.height);
  for (const auto& polygon : floor) mark(polygon, grid, has_floor);
  const Slab slab{floor_z_m + config.low_m, floor_z_m + config.high_m};
  for (const auto& triangle : mesh.triangles) {
    if (meets(mesh, triangle, slab) && is_solid(triangle.part))
      mark(clip(corners_of(mesh, triangle), slab), grid, blocked);
  }
  for (std::size_t i = 0; i < blocked.pixels.size(); ++i) {
    if (has_floor.pixels[i] == 0) blocked.pixels[i] = 255;
  }
  return NavMap(grid, std::move(blocked));
}

NavMap build_nav_map(const Scene& scene, const NavMapConfig& config,
                     const std::vector<std::uint16_t>& passable_classes) {
  const auto is_solid = [&](std::uint32_t part) {
    const std::uint16_t id = scene.instances.at(part).class_id;
    return std::find(passable_classes.begin(), passable_classes.end(), id) == passable_classes.end();
  };
  return build_nav_map(scene.mesh, scene.floor_z_m, config, is_solid);
}

}  // namespace lapis::simulator
