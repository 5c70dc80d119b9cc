#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace lapis::files {

/// Removes the oldest files of a folder with this extension (".light") until the remaining files have at most `most`
/// bytes in total. Other processes may do the same at the same time, so files that cannot be read or removed are
/// skipped.
void keep_newest(const std::filesystem::path& folder, const std::string& extension, std::uintmax_t most);

}  // namespace lapis::files
