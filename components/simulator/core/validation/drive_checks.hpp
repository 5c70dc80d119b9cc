#pragma once

#include <vector>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/reachability.hpp"
#include "simulator/core/robot/tour.hpp"
#include "simulator/core/scene/scene.hpp"
#include "simulator/core/validation/report.hpp"

namespace lapis::simulator {

/// Loops shorter than this lead around a table, not through a building.
inline constexpr double kLeastLoop_m = 8.0;

/// Checks that no start is nearer to an obstacle than the robot's radius.
Check check_starts(const Scene& scene, const NavMap& map, double radius_m);

/// Checks that the robot reaches every room from every start: at least 5 % of its floor.
Check check_rooms(const Scene& scene, const NavMap& map, double radius_m);

/// Checks that the bundled tour can be driven from every start.
Check check_tour(const Scene& scene, const NavMap& map, const TourConfig& config);

/// Checks that no passage from one room to another is narrower than 0.8 m.
Check check_doors(const Scene& scene, const NavMap& map);

/// Checks rooms of type "hallway" or "corridor": the largest disc that can move from every doorway to all others
/// without leaving the corridor must be at least 0.8 m wide; the verdict is a note when it is narrower than 1.2 m, or
/// when there are no two doorways.
Check check_corridors(const Scene& scene, const NavMap& map);

/// Loops of at least kLeastLoop_m that can be reached from the first start.
std::vector<FreeLoop> long_loops(const Scene& scene, const NavMap& map, double radius_m);

/// Lists long_loops; it never fails.
Check list_loops(const Scene& scene, const NavMap& map, double radius_m);

}  // namespace lapis::simulator
