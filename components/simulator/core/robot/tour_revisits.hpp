#pragma once

#include "simulator/core/robot/tour.hpp"

namespace lapis::simulator {

/// Waypoints of the same tour with forced revisits, in the world frame [m]. After every `spacing_m` of the tour's path
/// (> 0), the robot drives to the nearest of the places that it passed at least `spacing_m` of path earlier, passes it
/// in the same direction as before, so that the camera sees the same views, and returns to where it left the tour.
std::vector<Eigen::Vector2d> with_revisits(const NavMap& map, const Tour& tour, double spacing_m,
                                           const PathConfig& config);

}  // namespace lapis::simulator
