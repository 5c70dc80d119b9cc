#include "simulator/core/loaders/csv_table.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/text_scan.hpp"

namespace lapis::simulator {
namespace {

// Removes a quoted field from `rest`. Returns false and removes nothing when the closing quote is missing, or when
// neither the separator nor the end of the line follows it.
bool take_quoted(std::string_view& rest, char separator, std::string& field) {
  std::string text;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i] != '"') {
      text += rest[i];
    } else if (i + 1 < rest.size() && rest[i + 1] == '"') {
      text += rest[i++];
    } else if (i + 1 == rest.size() || rest[i + 1] == separator) {
      field = std::move(text);
      rest.remove_prefix(i + 1);
      return true;
    } else {
      return false;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> split_fields(std::string_view line, char separator) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.remove_suffix(1);
  std::vector<std::string> fields;
  while (true) {
    std::string field;
    if (line.empty() || line.front() != '"' || !take_quoted(line, separator, field)) {
      const std::size_t end = std::min(line.find(separator), line.size());
      field = line.substr(0, end);
      line.remove_prefix(end);
    }
    fields.push_back(std::move(field));
    if (line.empty()) return fields;
    line.remove_prefix(1);
  }
}

CsvTable::CsvTable(std::string_view text, char separator, std::string file) : file_(std::move(file)) {
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view content = take_line(text);
    if (trimmed(content).empty()) continue;
    if (columns_.empty()) {
      columns_ = split_fields(content, separator);
    } else {
      rows_.push_back({line, split_fields(content, separator)});
    }
  }
}

bool CsvTable::has(std::string_view column) const {
  return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
}

const std::string& CsvTable::at(const Row& row, std::string_view column) const {
  const auto it = std::find(columns_.begin(), columns_.end(), column);
  if (it == columns_.end()) {
    throw std::runtime_error(file_ + ": line 1: there is no column '" + std::string(column) + "'; name it there");
  }
  const auto index = static_cast<std::size_t>(it - columns_.begin());
  if (index >= row.fields.size()) fail(row, "the field '" + std::string(column) + "' is missing; complete the line");
  return row.fields[index];
}

std::size_t CsvTable::index_at(const Row& row, std::string_view column, std::size_t largest) const {
  const std::string& text = at(row, column);
  const auto value = to_number<std::size_t>(trimmed(text));
  if (!value || *value > largest) {
    fail(row, std::string(column) + " must be a whole number up to " + std::to_string(largest) + ", not '" +
                  text.substr(0, 40) + "'");
  }
  return *value;
}

float CsvTable::float_at(const Row& row, std::string_view column) const {
  const std::string& text = at(row, column);
  const auto value = to_float(trimmed(text));
  if (!value) fail(row, std::string(column) + " must be a finite number, not '" + text.substr(0, 40) + "'");
  return *value;
}

void CsvTable::fail(const Row& row, const std::string& what) const {
  throw std::runtime_error(file_ + ": line " + std::to_string(row.line) + ": " + what);
}

}  // namespace lapis::simulator
