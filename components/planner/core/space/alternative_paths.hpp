#pragma once

#include <vector>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {

/// Up to `count` paths to one goal; the first is the cheapest. Empty when there is none. Every other path is at most
/// max_detour times as long as the first, is somewhere at least min_apart_m away from each path before it, and belongs
/// to another homotopy class: the two paths enclose a cell that is not free. The search raises the cost around all
/// paths found so far and searches again, at most three times per wanted path, so that it may miss paths that cost much
/// more than the first.
std::vector<Path> find_alternatives(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to, int count);

}  // namespace lapis::planner
