#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// One line of a text file, split at blanks or another separator.
struct TableRow {
  int line = 0;  ///< counted from 1
  std::vector<std::string> fields;
};

/// Reads the lines of a text file that are neither empty nor comments ('#'). Windows line ends are accepted.
/// @throws std::runtime_error when the file cannot be read.
std::vector<TableRow> read_table(const std::filesystem::path& file, char separator = ' ');

/// Decimal seconds ("1305031102.175304") to whole nanoseconds, without the rounding of a double. Digits beyond the
/// ninth decimal are cut off. Empty when the text is anything else or beyond the range of Time.
std::optional<time::Time> parse_stamp(std::string_view text);

/// A finite number; empty when the text is anything else.
std::optional<double> parse_number(std::string_view text);

/// Throws std::runtime_error("<file>:<line>: <what>").
[[noreturn]] void fail_at(const std::filesystem::path& file, int line, const std::string& what);

}  // namespace lapis::sensor_replay
