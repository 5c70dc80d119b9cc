#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

namespace lapis::semantic_mapper {

/// `merge A B... --out FILE [--transform X,Y,Z,ROLL,PITCH,YAW]...`: writes the sum of the counts of maps.
void add_merge_tool(CLI::App& app, std::ostream& out);

}  // namespace lapis::semantic_mapper
