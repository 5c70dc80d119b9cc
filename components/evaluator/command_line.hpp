#pragma once

#include "common/runtime/file_tools.hpp"

namespace lapis::evaluator {

/// `lapis_evaluator ate|rpe|map|iou|coverage ...`.
void add_file_tools(CLI::App& app, std::ostream& out);

inline constexpr runtime::FileTools kFileTools{
    "lapis_evaluator", "Metrics on files: what a run of SLAM and mapping is worth", &add_file_tools};

}  // namespace lapis::evaluator
