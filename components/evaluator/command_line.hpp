#pragma once

#include <iosfwd>
#include <string_view>

namespace lapis::evaluator {

/// True when `word`, the first argument of lapis_evaluator, names one of the tools on files below.
bool is_file_tool(std::string_view word);

/// Runs `lapis_evaluator ate|rpe|map|iou|coverage ...`. Results go to `out`, messages to `err`. Returns the exit
/// status: 0, or 2 for wrong arguments and inputs that cannot be evaluated.
int run_file_tool(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace lapis::evaluator
