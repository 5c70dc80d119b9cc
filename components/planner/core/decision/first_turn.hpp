#pragma once

#include <vector>

#include "planner/core/decision/decision.hpp"

namespace lapis::planner {

/// Headings through which the robot turns before it drives a path that begins with `heading_rad`, the last one of them
/// [rad]: the longer way round when the shorter one leads past a view with fewer landmarks than slam needs, and the
/// longer one does not. Empty when the shorter way will do, as without landmarks.
std::vector<double> first_turn(const Situation& situation, double heading_rad, const CovisibilityConfig& config);

}  // namespace lapis::planner
