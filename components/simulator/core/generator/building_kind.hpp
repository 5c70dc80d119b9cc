#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lapis::simulator {

/// Kind of a generated building.
enum class BuildingKind {
  kFlat,       ///< a hallway with rooms on both sides; a living room at its end, often joined to the kitchen: 55-130 m2
  kOffice,     ///< a corridor, or two that meet, with rooms on both sides; some are copies of each other
  kRing,       ///< a corridor of 40-80 m around a block of rooms, with blank stretches
  kWarehouse,  ///< a high hall with long racks, and a few rooms along one side
  kClinic      ///< corridors and rooms without texture; most rooms are copies, turned and mirrored
};

/// Names of the kinds, in the order of the enumeration.
const std::vector<std::string>& building_kinds();

/// Kind and seed of a generated building.
struct BuildingName {
  BuildingKind kind = BuildingKind::kFlat;
  std::uint64_t seed = 1;
  bool has_panes = false;  ///< panes of glass and mirrors stand free in rooms
};

/// Name of a generated building in commands and tables: "office_17", with panes "office_17_panes".
std::string to_string(const BuildingName& name);

/// Reads such a name; nothing for texts of another form.
std::optional<BuildingName> parse_building_name(const std::string& text);

}  // namespace lapis::simulator
