#include "sensor_replay/core/text_table.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace lapis::sensor_replay {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> fields;
  const std::string blanks = separator == ' ' ? " \t" : std::string(1, separator);
  std::size_t begin = 0;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    // A run of blanks is one separator, but between two commas there is an empty field.
    if (end > begin || separator != ' ') fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

// Parses digits; empty for any other text.
std::optional<std::int64_t> parse_digits(std::string_view text) {
  std::int64_t value = 0;
  if (text.empty() || text.front() < '0' || text.front() > '9') return std::nullopt;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::vector<TableRow> read_table(const std::filesystem::path& file, char separator) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<TableRow> rows;
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string::npos || text[first] == '#') continue;
    rows.push_back({line, split(text, separator)});
  }
  return rows;
}

std::optional<time::Time> parse_stamp(std::string_view text) {
  const bool is_negative = !text.empty() && text.front() == '-';
  if (is_negative) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  const auto seconds = parse_digits(text.substr(0, point));
  if (!seconds || *seconds >= std::numeric_limits<std::int64_t>::max() / kNanosecondsPerSecond) return std::nullopt;
  std::int64_t fraction_ns = 0;
  if (point != std::string_view::npos) {
    std::string decimals(text.substr(point + 1));
    if (decimals.empty() || decimals.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    decimals.resize(9, '0');
    fraction_ns = *parse_digits(decimals);
  }
  const std::int64_t nanoseconds = *seconds * kNanosecondsPerSecond + fraction_ns;
  return time::Time{is_negative ? -nanoseconds : nanoseconds};
}

std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

void fail_at(const std::filesystem::path& file, int line, const std::string& what) {
  throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + what);
}

}  // namespace lapis::sensor_replay
