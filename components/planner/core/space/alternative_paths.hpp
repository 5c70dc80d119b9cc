#pragma once

#include <vector>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {

/// Up to `count` paths to one goal, the cheapest first; empty when there is none. Every other one is at most
/// max_detour times as long as the first, is somewhere min_apart_m away from each one before, and is of another
/// homotopy class: the two enclose a cell that is not free. Found by raising the cost around all paths seen so far and
/// searching again, at most three times per path wanted: what costs much more than the first may be missed.
std::vector<Path> find_alternatives(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to, int count);

}  // namespace lapis::planner
