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

/// What a scene is made of.
struct Inventory {
  std::vector<Item> items;               ///< in the order of Scene::instances
  std::vector<std::uint32_t> structure;  ///< triangles of the building
};

/// Takes the building (classes wall, floor, ceiling, door, and window) apart from the items. Instances that are parts
/// of one piece of furniture ("vanity", "vanity/sink") are one item.
Inventory take_inventory(const Scene& scene);

/// Only these triangles, with their looks.
Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& triangles);

/// Points that cover the triangles: no place on them is farther than `spacing_m` from a point [m].
/// @throws std::runtime_error in one line with the remedy when the triangles are so large that these are too many.
std::vector<Eigen::Vector3f> surface_points(const Mesh& mesh, const std::vector<std::uint32_t>& triangles,
                                            float spacing_m);

}  // namespace lapis::simulator
