#pragma once

#include <iosfwd>
#include <string_view>

namespace lapis::semantic_mapper {

/// True when `word`, the first argument of lapis_semantic_mapper, names one of the tools on files below.
bool is_file_tool(std::string_view word);

/// Runs `lapis_semantic_mapper convert|info|merge ...`, without DDS. Results go to `out`, messages to `err`. Returns
/// the exit status: 0, or 2 for wrong arguments and files that cannot be read or written.
int run_file_tool(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace lapis::semantic_mapper
