#include "common/report/report.hpp"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

namespace lapis::report {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kNameWidth = 26;

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text + "  ";
}

std::string text_of(const ordered_json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "";
  if (!value.is_number_float()) return value.dump();
  char text[400];
  std::snprintf(text, sizeof text, "%.6f", value.get<double>());
  return text;
}

std::string without_tail_blanks(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

std::string pairs_of(const ordered_json& object) {
  std::string line;
  for (const auto& [key, value] : object.items()) line += key + " " + text_of(value) + "  ";
  return line;
}

void print_table(std::ostream& out, const std::string& name, const ordered_json& rows) {
  std::vector<std::vector<std::string>> cells(rows.size() + 1);
  for (const auto& [key, value] : rows.front().items()) cells[0].push_back(key);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [key, value] : rows[i].items()) cells[i + 1].push_back(text_of(value));
  }
  out << name << ":\n";
  for (const auto& row : cells) {
    std::string line = "  ";
    for (std::size_t column = 0; column < row.size(); ++column) {
      std::size_t width = 0;
      for (const auto& other : cells) width = std::max(width, other[column].size());
      line += padded(row[column], width);
    }
    out << without_tail_blanks(line) << '\n';
  }
}

}  // namespace

void print(std::ostream& out, const ordered_json& result, bool as_json) {
  if (as_json) {
    out << result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    return;
  }
  for (const auto& [key, value] : result.items()) {
    if (value.is_array() && !value.empty() && value.front().is_object()) {
      print_table(out, key, value);
    } else {
      out << without_tail_blanks(padded(key, kNameWidth) + (value.is_object() ? pairs_of(value) : text_of(value)))
          << '\n';
    }
  }
}

}  // namespace lapis::report
