#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/looks/shapes.hpp"
#include "simulator/core/looks/textures.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Greatest number of triangles of a scene: 2 GB of memory, with the structures for rendering.
inline constexpr std::size_t kMaxTriangles = 20'000'000;

/// Appends an instance and returns its index, which is the `part` of its triangles.
/// @throws std::runtime_error when there are more than 65535 instances or kMaxTriangles triangles
std::uint32_t add_instance(Scene& scene, const std::string& class_name, const std::string& name);

/// Adds walls, floors, ceilings, doors and windows of all rooms to a scene: one instance per wall, floor, and ceiling
/// of a room, and one per door and window. Every room has walls of its own, which are visible from its inside. Walls,
/// floors and ceilings are cut into cells of 0.2 m, so that they can carry light.
void add_structure(Scene& scene, const SceneSpec& spec, const std::vector<RoomPlan>& plan, TextureLibrary& textures);

}  // namespace lapis::simulator
