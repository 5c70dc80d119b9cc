#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace lapis::files {

/// Removes the oldest files of a folder with this extension (".light") until those that are left have no more than
/// `most` bytes together. Others may do the same meanwhile: what fails is left.
void keep_newest(const std::filesystem::path& folder, const std::string& extension, std::uintmax_t most);

}  // namespace lapis::files
