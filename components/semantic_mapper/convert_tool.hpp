#pragma once

#include <CLI/CLI.hpp>

namespace lapis::semantic_mapper {

/// `convert IN OUT`: writes a map in another format, chosen by the extension.
void add_convert_tool(CLI::App& app);

}  // namespace lapis::semantic_mapper
