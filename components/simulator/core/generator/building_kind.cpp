#include "simulator/core/generator/building_kind.hpp"

#include <algorithm>
#include <charconv>

namespace lapis::simulator {
namespace {

constexpr const char* kPanes = "_panes";

}  // namespace

const std::vector<std::string>& building_kinds() {
  static const std::vector<std::string> names{"flat", "office", "ring", "warehouse", "clinic"};
  return names;
}

std::string to_string(const BuildingName& name) {
  return building_kinds()[static_cast<std::size_t>(name.kind)] + '_' + std::to_string(name.seed) +
         (name.has_panes ? kPanes : "");
}

std::optional<BuildingName> parse_building_name(const std::string& text) {
  const std::size_t split = text.find('_');
  if (split == std::string::npos) return std::nullopt;
  const auto& kinds = building_kinds();
  const auto kind = std::find(kinds.begin(), kinds.end(), text.substr(0, split));
  BuildingName name;
  const char *first = text.data() + split + 1, *last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, name.seed);
  if (kind == kinds.end() || error != std::errc()) return std::nullopt;
  name.has_panes = end != last;
  name.kind = static_cast<BuildingKind>(kind - kinds.begin());
  if (to_string(name) != text) return std::nullopt;  // such as "office_007" or "office_7x"
  return name;
}

}  // namespace lapis::simulator
