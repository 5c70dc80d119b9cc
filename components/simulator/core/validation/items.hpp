#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// A thing that was put into a building: furniture, a picture, a lamp.
struct Item {
  std::string name;
  std::uint16_t class_id = 0;
  std::vector<std::uint32_t> triangles;  ///< in Scene::mesh; never empty
  Eigen::AlignedBox3f box;               ///< [m]
};

/// The items and the building of a scene.
struct Inventory {
  std::vector<Item> items;               ///< in the order of Scene::instances
  std::vector<std::uint32_t> structure;  ///< triangles of the building
};

/// Separates the building (classes wall, floor, ceiling, door, and window) from the items. Instances that are parts of
/// one piece of furniture ("vanity", "vanity/sink") are one item.
Inventory take_inventory(const Scene& scene);

/// A mesh of these triangles only, with their materials and textures.
Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& triangles);

/// Points that cover the triangles: no place on them is farther than `spacing_m` from a point [m].
/// @throws std::runtime_error with one line that names the remedy, when the triangles need too many points.
std::vector<Eigen::Vector3f> surface_points(const Mesh& mesh, const std::vector<std::uint32_t>& triangles,
                                            float spacing_m);

}  // namespace lapis::simulator
