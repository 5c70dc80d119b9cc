#pragma once

#include <filesystem>
#include <string>

namespace lapis::evaluator {

/// The whole file. Throws std::runtime_error naming the file when it is missing, a folder, or unreadable.
std::string read_text_file(const std::filesystem::path& file);

/// Writes `file` beside itself and renames it: readers and a kill see the old content or the new, never a part.
/// Throws std::runtime_error naming the file (folder missing, no permission, no space); the old file stays whole.
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace lapis::evaluator
