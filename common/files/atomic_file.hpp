#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lapis::files {

/// Replaces a file as a whole: the bytes go to "<path>.part" in the same folder, are flushed to the disk, and only then
/// take the old file's name. At any failure (no space, no permission, no folder) the old file stays untouched, the part
/// file is removed, and the reason, which names the file, is returned. Nothing is returned on success.
[[nodiscard]] std::optional<std::string> replace_file(const std::string& path, std::span<const std::uint8_t> bytes);

/// The same for text; throws std::runtime_error with the reason.
void replace_text(const std::filesystem::path& path, std::string_view text);

/// Renames a file to the first name of "<stem>.1<extension>", "<stem>.2<extension>", ... that is free, so that a new
/// file does not replace it. Does nothing when the file does not exist. Returns the reason when the file cannot be
/// renamed.
[[nodiscard]] std::optional<std::string> set_aside(const std::filesystem::path& path);

/// Content of a file. When it cannot be read, returns nothing and sets `error` to the reason, which names the file.
std::optional<std::vector<std::uint8_t>> read_file(const std::string& path, std::string& error);

/// Makes sure that a folder exists and that files can be written into it; creates it and its parents when they are
/// missing. Throws std::runtime_error, which names the folder and the configuration key that it comes from.
void require_writable_folder(const std::string& folder, const std::string& key);

}  // namespace lapis::files
