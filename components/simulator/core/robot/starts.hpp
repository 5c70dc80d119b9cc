#pragma once

#include <vector>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Cells where a robot may begin in a scene that names no starts: those of the largest connected area in which it has
/// 0.2 m of room around it, and so neither a closed room nor the hollow of a piece of furniture. They are in row-major
/// order, and empty when the robot fits nowhere.
std::vector<Cell> open_cells(const NavMap& map, double radius_m);

/// The scene's starts; when it has none, the place in open_cells() that is farthest from all obstacles.
/// @throws std::runtime_error naming the scene when the robot fits nowhere
std::vector<StartPose> starts_of(const Scene& scene, const NavMap& map, double radius_m);

}  // namespace lapis::simulator
