#pragma once

#include <filesystem>

#include "supervisor/core/system.hpp"

namespace lapis::supervisor {

/// Reads config/systems/<name>.yaml. File names in it are relative to its folder. Throws BadSetup, which names file,
/// line and key.
System read_system(const std::filesystem::path& file);

}  // namespace lapis::supervisor
