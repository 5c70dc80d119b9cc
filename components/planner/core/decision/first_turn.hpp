#pragma once

#include <vector>

#include "planner/core/candidates/situation.hpp"

namespace lapis::planner {

/// Headings through which the robot turns before it drives a path that begins with `heading_rad`, the last one of them
/// [rad]: the longer way round when the shorter one leads past a view with fewer landmarks than slam needs, and the
/// longer one does not. Empty when the shorter way will do, as without landmarks.
/// @param side of a turn the longer way that has begun: 1 to the left, -1 to the right; else 0. It is not reversed
/// before a short turn is left: views are predicted anew from every heading, and both sides may have a weak one
std::vector<double> first_turn(const Situation& situation, double heading_rad, int side,
                               const CovisibilityConfig& config);

}  // namespace lapis::planner
