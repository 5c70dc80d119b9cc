#pragma once

#include "simulator/core/robot/tour.hpp"

namespace lapis::simulator {

/// Waypoints of the same tour with forced revisits. After every `spacing_m` of the tour's path (> 0) the robot drives
/// to the nearest of the places that it passed at least so much of the path earlier, passes it in the direction of
/// then, so that the camera sees what it saw, and comes back to continue where it left. All in the world frame [m].
std::vector<Eigen::Vector2d> with_revisits(const NavMap& map, const Tour& tour, double spacing_m,
                                           const PathConfig& config);

}  // namespace lapis::simulator
