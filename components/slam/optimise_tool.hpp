#pragma once

#include "common/runtime/file_tools.hpp"

namespace lapis::slam {

/// `lapis_slam optimise FILE.g2o [--out FILE] [--robust]`.
void add_file_tools(CLI::App& app, std::ostream& out);

inline constexpr runtime::FileTools kFileTools{"lapis_slam", "RGB-D SLAM: tools on files", &add_file_tools};

}  // namespace lapis::slam
