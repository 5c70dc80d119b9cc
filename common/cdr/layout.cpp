#include "common/cdr/layout.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <utility>

namespace lapis::cdr {
namespace {

constexpr std::array<std::pair<std::string_view, Kind>, 14> kPrimitives{{{"bool", Kind::kBool},
                                                                         {"byte", Kind::kByte},
                                                                         {"char", Kind::kUint8},
                                                                         {"int8", Kind::kInt8},
                                                                         {"uint8", Kind::kUint8},
                                                                         {"int16", Kind::kInt16},
                                                                         {"uint16", Kind::kUint16},
                                                                         {"int32", Kind::kInt32},
                                                                         {"uint32", Kind::kUint32},
                                                                         {"int64", Kind::kInt64},
                                                                         {"uint64", Kind::kUint64},
                                                                         {"float32", Kind::kFloat32},
                                                                         {"float64", Kind::kFloat64},
                                                                         {"string", Kind::kString}}};
constexpr std::string_view kNextType = "MSG: ";

[[noreturn]] void fail(std::string_view line, const std::string& problem) {
  throw std::runtime_error("declaration '" + std::string(line) + "': " + problem);
}

/// "sensor_msgs/msg/Image" -> "sensor_msgs/Image", as declarations call types.
std::string short_name(std::string_view ros_name) {
  const std::size_t first = ros_name.find('/'), last = ros_name.rfind('/');
  if (first == std::string_view::npos) return std::string(ros_name);
  return std::string(ros_name.substr(0, first)) + std::string(ros_name.substr(last));
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string_view::npos ? "" : text.substr(begin, end - begin + 1);
}

std::size_t count_of(std::string_view line, std::string_view text) {
  std::size_t count = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), count);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() || count == 0) {
    fail(line, "'" + std::string(text) + "' is no size");
  }
  return count;
}

/// A field whose type is not resolved yet.
struct Declared {
  Field field;
  std::string type;  ///< of another structure; empty: a primitive
};

/// Takes "[]", "[9]" or "[<=9]" off the end of a type.
std::string_view take_container(std::string_view line, std::string_view type, Field& field) {
  if (!type.ends_with(']')) return type;
  const std::size_t open = type.rfind('[');
  if (open == std::string_view::npos) fail(line, "no [ before ]");
  const std::string_view inside = type.substr(open + 1, type.size() - open - 2);
  const bool is_bounded = inside.starts_with("<=");
  field.container = inside.empty() || is_bounded ? Container::kSequence : Container::kArray;
  if (!inside.empty()) field.capacity = count_of(line, inside.substr(is_bounded ? 2 : 0));
  return type.substr(0, open);
}

/// A line "type name" or "type name default"; nothing for a constant "type NAME=value" and for an empty line.
std::optional<Declared> parse_line(std::string_view line, const std::string& package) {
  const std::string_view text = trimmed(line.substr(0, line.find('#')));
  if (text.empty()) return std::nullopt;
  const std::size_t space = text.find_first_of(" \t");
  if (space == std::string_view::npos) fail(line, "a type and a name are wanted");
  const std::string_view rest = trimmed(text.substr(space));
  if (rest.substr(0, rest.find_first_of("\"' \t")).find('=') != std::string_view::npos) return std::nullopt;
  Declared declared;
  declared.field.name = rest.substr(0, rest.find_first_of(" \t"));
  std::string_view type = take_container(line, text.substr(0, space), declared.field);
  if (const std::size_t bound = type.find("<="); bound != std::string_view::npos) {
    declared.field.string_bound = count_of(line, type.substr(bound + 2));
    type = type.substr(0, bound);
  }
  const auto* primitive = std::ranges::find(kPrimitives, type, [](const auto& entry) { return entry.first; });
  declared.field.kind = primitive == kPrimitives.end() ? Kind::kStructure : primitive->second;
  if (declared.field.kind == Kind::kStructure) {
    declared.type = type.find('/') == std::string_view::npos ? package + "/" + std::string(type) : short_name(type);
  }
  return declared;
}

struct DeclaredStructure {
  std::string name;
  std::vector<Declared> fields;
};

std::vector<DeclaredStructure> parse_structures(std::string_view ros_name, std::string_view text) {
  std::vector<DeclaredStructure> found{{short_name(ros_name), {}}};
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("====")) continue;
    if (line.starts_with(kNextType)) {
      found.push_back({short_name(trimmed(line.substr(kNextType.size()))), {}});
      continue;
    }
    const std::string package = found.back().name.substr(0, found.back().name.find('/'));
    if (auto declared = parse_line(line, package)) found.back().fields.push_back(std::move(*declared));
  }
  return found;
}

/// Each structure uses only others, and none of them itself: those that follow have been looked at before.
void check_that_it_ends(const Layout& layout, std::size_t index, std::vector<bool>& is_open) {
  if (is_open[index]) fail(layout.structures[index].name, "it contains itself");
  is_open[index] = true;
  for (const Field& field : layout.structures[index].fields) {
    if (field.kind == Kind::kStructure) check_that_it_ends(layout, field.structure, is_open);
  }
  is_open[index] = false;
}

}  // namespace

Layout parse_ros2msg(std::string_view ros_name, std::string_view text) {
  const std::vector<DeclaredStructure> declared = parse_structures(ros_name, text);
  Layout layout;
  for (const DeclaredStructure& structure : declared) {
    Structure& made = layout.structures.emplace_back(Structure{structure.name, {}});
    for (const Declared& field : structure.fields) {
      made.fields.push_back(field.field);
      if (field.type.empty()) continue;
      const auto other = std::ranges::find(declared, field.type, &DeclaredStructure::name);
      if (other == declared.end()) fail(field.field.name, "type " + field.type + " is not declared");
      made.fields.back().structure = static_cast<std::size_t>(other - declared.begin());
    }
  }
  require_an_end(layout);
  return layout;
}

void require_an_end(const Layout& layout) {
  std::vector<bool> is_open(layout.structures.size());
  check_that_it_ends(layout, 0, is_open);
}

}  // namespace lapis::cdr
