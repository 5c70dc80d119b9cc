#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lapis::simulator {

/// What a generated building is like.
enum class BuildingKind {
  kFlat,       ///< a hallway with rooms on both sides, and a living room at its end that a second door joins: 55-130 m2
  kOffice,     ///< a corridor, or two that meet, with rooms on both sides; some are copies of each other
  kRing,       ///< a corridor of 40-80 m round a block of rooms, with blank stretches
  kWarehouse,  ///< a high hall with long racks, and a few rooms along one side
  kClinic      ///< corridors and rooms without texture; most rooms are copies, turned and mirrored
};

/// In the order of the enumeration.
const std::vector<std::string>& building_kinds();

/// A building that can be drawn.
struct BuildingName {
  BuildingKind kind = BuildingKind::kFlat;
  std::uint64_t seed = 1;
  bool has_panes = false;  ///< of glass, and mirrors, that stand free in rooms
};

/// "office_17", with panes "office_17_panes": how commands and tables call a generated building.
std::string to_string(const BuildingName& name);

/// Nothing for names that are not of this form.
std::optional<BuildingName> parse_building_name(const std::string& text);

}  // namespace lapis::simulator
