#pragma once

#include "common/runtime/file_tools.hpp"

namespace lapis::semantic_mapper {

/// `lapis_semantic_mapper convert|info|merge ...`.
void add_file_tools(CLI::App& app, std::ostream& out);

inline constexpr runtime::FileTools kFileTools{"lapis_semantic_mapper", "Semantic mapping: tools on files",
                                               &add_file_tools};

}  // namespace lapis::semantic_mapper
