#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/scene/scene.hpp"
#include "tests/unit/simulator/render/box_scene.hpp"

namespace lapis::simulator::test {

/// Adds the six faces of a box as one instance.
inline void add_box(Scene& scene, const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint16_t class_id) {
  if (scene.mesh.materials.empty()) scene.mesh.materials.push_back({"grey", {200, 200, 200}});
  const auto part = static_cast<std::uint32_t>(scene.instances.size());
  scene.instances.push_back({static_cast<std::uint16_t>(part + 1), class_id, "box " + std::to_string(part + 1)});
  const auto corner = [&](int i) {
    return Eigen::Vector3f((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                           (i & 4) != 0 ? high.z() : low.z());
  };
  for (const std::array<int, 4>& q :
       {std::array{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}) {
    add_quad(scene, {{corner(q[0]), corner(q[1]), corner(q[2]), corner(q[3])}}, 0, part);
  }
}

/// An empty room of one class from the origin to `size`, with names for classes 1 to 9.
inline Scene room(const Eigen::Vector3f& size, std::uint16_t class_id = 1) {
  Scene scene;
  scene.name = "room";
  std::vector<std::pair<std::uint16_t, std::string>> names;
  for (std::uint16_t id = 1; id <= 9; ++id) names.emplace_back(id, "class " + std::to_string(id));
  scene.labels = mapping::LabelList::from_names(names);
  add_box(scene, {0, 0, 0}, size, class_id);
  return scene;
}

inline geometry::Pose translation(double x, double y, double z) {
  return geometry::make_pose({x, y, z}, Eigen::Quaterniond::Identity());
}

inline geometry::Pose planar_pose(double x, double y, double yaw_rad) {
  return geometry::make_pose({x, y, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())));
}

}  // namespace lapis::simulator::test
