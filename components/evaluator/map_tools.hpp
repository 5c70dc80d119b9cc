#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

namespace lapis::evaluator {

/// Adds `map` (distances between occupied voxels), `iou` (agreement of classes) and `coverage` (explored volume) of
/// one map.lapis file against another.
void add_map_tools(CLI::App& app, std::ostream& out);

}  // namespace lapis::evaluator
