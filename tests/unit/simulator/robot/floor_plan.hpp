#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "simulator/core/robot/nav_map.hpp"

namespace lapis::simulator {

/// Axis-aligned rectangle on the floor plan [m].
struct Rectangle {
  double x0, y0, x1, y1;
  bool contains(const Eigen::Vector2d& p) const { return p.x() > x0 && p.x() < x1 && p.y() > y0 && p.y() < y1; }
};

/// Map of width x height metres from the origin; blocked are the cells whose centre lies in an obstacle, and the
/// border.
inline NavMap map_of(double width_m, double height_m, const std::vector<Rectangle>& obstacles,
                     double resolution_m = 0.025) {
  const Grid grid{
      {0, 0}, resolution_m, static_cast<int>(width_m / resolution_m), static_cast<int>(height_m / resolution_m)};
  geometry::GrayImage blocked(grid.width, grid.height);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      for (const auto& obstacle : obstacles) {
        if (obstacle.contains(grid.center({column, row}))) blocked(column, row) = 255;
      }
    }
  }
  return NavMap(grid, blocked);
}

/// Uniform in [low, high), the same on every platform.
inline double draw(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1.0p-53;
}

inline void add_quad(Mesh& mesh, const std::array<Eigen::Vector3f, 4>& corners, std::uint32_t part) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({{first, first + 1, first + 2}, 0, part});
  mesh.triangles.push_back({{first, first + 2, first + 3}, 0, part});
}

/// Level rectangle at height z.
inline void add_level(Mesh& mesh, const Rectangle& r, double z, std::uint32_t part) {
  const auto at = [&](double x, double y) -> Eigen::Vector3f { return Eigen::Vector3d(x, y, z).cast<float>(); };
  add_quad(mesh, {at(r.x0, r.y0), at(r.x1, r.y0), at(r.x1, r.y1), at(r.x0, r.y1)}, part);
}

/// The four sides and the top of a box.
inline void add_box(Mesh& mesh, const Rectangle& r, double z0, double z1, std::uint32_t part) {
  const auto at = [](double x, double y, double z) -> Eigen::Vector3f {
    return Eigen::Vector3d(x, y, z).cast<float>();
  };
  const auto side = [&](double ax, double ay, double bx, double by) {
    add_quad(mesh, {at(ax, ay, z0), at(bx, by, z0), at(bx, by, z1), at(ax, ay, z1)}, part);
  };
  side(r.x0, r.y0, r.x1, r.y0);
  side(r.x1, r.y0, r.x1, r.y1);
  side(r.x1, r.y1, r.x0, r.y1);
  side(r.x0, r.y1, r.x0, r.y0);
  add_level(mesh, r, z1, part);
}

}  // namespace lapis::simulator
