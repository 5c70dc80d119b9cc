#include "common/mapping/label_list.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace lapis::mapping {
namespace {

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view cell = line.substr(begin, end - begin);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '"')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '"')) cell.remove_suffix(1);
    cells.emplace_back(cell);
    begin = end + 1;
  }
  return cells;
}

/// Next line without its line end; false at the end of the text.
bool next_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = std::min(text.find('\n'), text.size());
  line = text.substr(0, end);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  text.remove_prefix(std::min(end + 1, text.size()));
  return true;
}

std::optional<std::uint16_t> parse_id(const std::string& cell) {
  std::uint16_t id = 0;
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), id);
  if (code != std::errc{} || end != cell.data() + cell.size()) return std::nullopt;
  return id;
}

std::size_t column(const std::vector<std::string>& header, std::string_view name) {
  return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
}

}  // namespace

geometry::Rgb8 default_color(std::uint16_t id) {
  if (id == 0) return {127, 127, 127};
  // Hue by the golden ratio keeps any run of ids apart; four steps of saturation and value keep equal hues apart.
  const double hue = std::fmod(id * 0.61803398874989485, 1.0) * 6.0;
  const double saturation = 0.55 + 0.15 * (id / 2 % 4);
  const double value = id % 2 == 0 ? 0.95 : 0.72;
  const auto channel = [&](double n) {  // HSV to RGB, channel n = 5, 3, 1
    const double k = std::fmod(n + hue, 6.0);
    return value - value * saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
  };
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(v * 255.0)); };
  return {byte(channel(5.0)), byte(channel(3.0)), byte(channel(1.0))};
}

LabelList::LabelList(std::vector<Label> labels) : labels_(std::move(labels)) {
  std::sort(labels_.begin(), labels_.end(), [](const Label& a, const Label& b) { return a.id < b.id; });
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    const std::uint16_t id = labels_[i].id;
    if (id == 0) throw std::runtime_error("label list: id 0 means unlabelled and cannot name a class");
    if (i > 0 && labels_[i - 1].id == id) throw std::runtime_error("label list: id " + std::to_string(id) + " twice");
  }
}

LabelList LabelList::from_names(const std::vector<std::pair<std::uint16_t, std::string>>& names) {
  std::vector<Label> labels;
  for (const auto& [id, name] : names) labels.push_back({id, name, default_color(id)});
  return LabelList(std::move(labels));
}

std::optional<LabelList> LabelList::from_csv(std::string_view text, std::string& error) {
  std::string_view line;
  next_line(text, line);
  const std::vector<std::string> header = split(line);
  const std::size_t id_column = column(header, "class_id"), name_column = column(header, "class");
  if (id_column == header.size() || name_column == header.size()) {
    error = "line 1: columns class_id and class are needed";
    return std::nullopt;
  }
  std::vector<std::pair<std::uint16_t, std::string>> names;
  for (int number = 2; next_line(text, line); ++number) {
    if (line.empty()) continue;
    const std::vector<std::string> cells = split(line);
    const auto id = id_column < cells.size() ? parse_id(cells[id_column]) : std::nullopt;
    const bool is_known =
        id && std::any_of(names.begin(), names.end(), [&](const auto& entry) { return entry.first == *id; });
    if (!id || *id == 0 || is_known || name_column >= cells.size()) {
      error = "line " + std::to_string(number) + ": expected a new class_id in 1..65535 and a name";
      return std::nullopt;
    }
    names.emplace_back(*id, cells[name_column]);
  }
  return from_names(names);
}

const Label* LabelList::find(std::uint16_t id) const {
  const auto it = std::lower_bound(labels_.begin(), labels_.end(), id,
                                   [](const Label& label, std::uint16_t wanted) { return label.id < wanted; });
  return it != labels_.end() && it->id == id ? &*it : nullptr;
}

std::string LabelList::name(std::uint16_t id) const {
  if (id == 0) return "unlabelled";
  const Label* label = find(id);
  return label ? label->name : "class " + std::to_string(id);
}

geometry::Rgb8 LabelList::color(std::uint16_t id) const {
  const Label* label = find(id);
  return label ? label->color : default_color(id);
}

}  // namespace lapis::mapping
