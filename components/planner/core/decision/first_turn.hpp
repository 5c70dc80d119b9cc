#pragma once

#include <vector>

#include "planner/core/candidates/situation.hpp"

namespace lapis::planner {

/// Headings [rad] through which the robot turns before it drives a path that begins with `heading_rad`; the last one is
/// `heading_rad`, up to full turns. The longer way round is taken when the shorter one leads past a view with fewer
/// landmarks than slam needs and the longer one does not. Empty when the shorter way is good enough, as always without
/// landmarks.
/// @param side direction of a turn the longer way that has begun: 1 to the left, -1 to the right; else 0. Such a turn
/// is not reversed until only a short turn is left: the views are predicted again from every heading, and on both sides
/// one may have too few landmarks
std::vector<double> first_turn(const Situation& situation, double heading_rad, int side,
                               const CovisibilityConfig& config);

}  // namespace lapis::planner
