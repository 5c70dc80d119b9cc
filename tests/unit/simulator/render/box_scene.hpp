#pragma once

#include <vector>

#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator::test {

/// A quadrilateral as two triangles; corners in order, the first one at texture coordinate (0, 0).
inline void add_quad(Scene& scene, const std::array<Eigen::Vector3f, 4>& corners, std::uint32_t material,
                     std::uint32_t part) {
  Mesh& mesh = scene.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.texture_coordinates.insert(mesh.texture_coordinates.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.triangles.push_back({{first, first + 1, first + 2}, material, part});
  mesh.triangles.push_back({{first, first + 2, first + 3}, material, part});
}

/// A room from (0, 0, 0) to (4, 3, 2.5) m: instance i of class i is the wall -x, +x, -y, +y, floor, ceiling for i
/// = 1..6.
inline Scene box_scene() {
  Scene scene;
  scene.name = "box";
  const float x = 4.0F, y = 3.0F, z = 2.5F;
  scene.mesh.materials.push_back({"grey", {200, 200, 200}});
  for (std::uint16_t i = 1; i <= 6; ++i) scene.instances.push_back({i, i, "side " + std::to_string(i)});
  add_quad(scene, {{{0, 0, 0}, {0, y, 0}, {0, y, z}, {0, 0, z}}}, 0, 0);
  add_quad(scene, {{{x, 0, 0}, {x, y, 0}, {x, y, z}, {x, 0, z}}}, 0, 1);
  add_quad(scene, {{{0, 0, 0}, {x, 0, 0}, {x, 0, z}, {0, 0, z}}}, 0, 2);
  add_quad(scene, {{{0, y, 0}, {x, y, 0}, {x, y, z}, {0, y, z}}}, 0, 3);
  add_quad(scene, {{{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}}}, 0, 4);
  add_quad(scene, {{{0, 0, z}, {x, 0, z}, {x, y, z}, {0, y, z}}}, 0, 5);
  return scene;
}

}  // namespace lapis::simulator::test
