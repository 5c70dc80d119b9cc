#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

namespace lapis::semantic_mapper {

/// `info FILE [--json]`: prints what is in a map.
void add_info_tool(CLI::App& app, std::ostream& out);

}  // namespace lapis::semantic_mapper
