#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

namespace lapis::evaluator {

/// Adds the tools `map` (distances between occupied voxels), `iou` (agreement of classes) and `coverage` (explored
/// volume), which compare one map.lapis file with another.
void add_map_tools(CLI::App& app, std::ostream& out);

}  // namespace lapis::evaluator
