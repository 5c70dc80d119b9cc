#pragma once

#include <vector>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/reachability.hpp"
#include "simulator/core/robot/tour.hpp"
#include "simulator/core/scene/scene.hpp"
#include "simulator/core/validation/report.hpp"

namespace lapis::simulator {

/// Loops shorter than this go round a table, not round a building.
inline constexpr double kLeastLoop_m = 8.0;

/// No start is nearer to an obstacle than the robot is wide.
Check check_starts(const Scene& scene, const NavMap& map, double radius_m);

/// The robot gets into every room from every start: to at least 5 % of the floor.
Check check_rooms(const Scene& scene, const NavMap& map, double radius_m);

/// The bundled tour can be driven, from every start.
Check check_tour(const Scene& scene, const NavMap& map, const TourConfig& config);

/// No passage from one room to another is narrower than 0.8 m.
Check check_doors(const Scene& scene, const NavMap& map);

/// In rooms of type "hallway" or "corridor": the largest disc that gets from every doorway to all others without
/// leaving the corridor is at least 0.8 m wide; a note when below 1.2 m, or when there are no two doorways.
Check check_corridors(const Scene& scene, const NavMap& map);

/// Loops of at least kLeastLoop_m from the first start.
std::vector<FreeLoop> long_loops(const Scene& scene, const NavMap& map, double radius_m);

/// Lists long_loops; never fails.
Check list_loops(const Scene& scene, const NavMap& map, double radius_m);

}  // namespace lapis::simulator
