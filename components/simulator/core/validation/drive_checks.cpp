#include "simulator/core/validation/drive_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <Eigen/Geometry>

#include "simulator/core/robot/regions.hpp"
#include "simulator/core/robot/starts.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kLeastReach = 0.05;  // share of a room's floor
constexpr double kLeastWidth_m = 0.8, kCorridorWidth_m = 1.2;
constexpr double kDoorway_m = 0.075;  // cells nearer than this to a corridor are just outside it
constexpr double kEntry_m = 1.2;      // a doorway leads to the most open place within this distance

std::string at(const Eigen::Vector2d& p) { return "(" + decimal(p.x(), 2) + ", " + decimal(p.y(), 2) + ")"; }

std::string start_name(const Scene& scene, std::size_t index) {
  return scene.starts.empty() ? "the most open place" : "start " + std::to_string(index + 1);
}

/// True when a width is certainly less than a limit: measured widths are up to two cells too small.
bool is_narrower(double width_m, double limit_m, const NavMap& map) {
  return width_m + 2.0 * map.grid().resolution_m < limit_m;
}

template <class Visit>
void for_all_cells(const Grid& grid, const Visit& visit) {
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) visit(Cell{column, row});
  }
}

/// A corridor by itself: everything outside its polygon is blocked.
NavMap inside_of(const NavMap& map, const Room& corridor) {
  const Grid& grid = map.grid();
  geometry::GrayImage blocked(grid.width, grid.height);
  for_all_cells(grid, [&](Cell c) {
    if (map.is_blocked(c) || !contains(corridor.polygon, grid.center(c))) blocked(c.column, c.row) = 255;
  });
  return {grid, std::move(blocked)};
}

/// Squares around the doorways of a corridor, which are where free space continues just outside its polygon.
std::vector<Room> entries(const NavMap& map, const Room& corridor) {
  const Grid& grid = map.grid();
  geometry::GrayImage outside(grid.width, grid.height);
  for_all_cells(grid, [&](Cell c) {
    const Eigen::Vector2d p = grid.center(c);
    if (map.is_blocked(c) || contains(corridor.polygon, p)) return;
    if (distance_to_border(corridor.polygon, p) < kDoorway_m) outside(c.column, c.row) = 255;
  });
  const Regions regions = find_regions(outside, Neighbours::kEight);
  std::vector<Eigen::AlignedBox2d> boxes(regions.sizes.size());
  for_all_cells(grid, [&](Cell c) {
    const std::uint32_t label = regions.labels(c.column, c.row);
    if (label != 0) boxes[label - 1].extend(grid.center(c));
  });
  std::vector<Room> rooms;
  for (const auto& box : boxes) {
    const Eigen::Vector2d p = box.center(), x(kEntry_m, 0), y(0, kEntry_m);
    rooms.push_back({"doorway " + at(p), "", {p - x - y, p + x - y, p + x + y, p - x + y}, corridor.height_m});
  }
  return rooms;
}

/// The narrowest place between the doorways of a corridor.
std::optional<Passage> narrowest(const NavMap& map, const Room& corridor) {
  const auto doorways = entries(map, corridor);
  const auto found = passages(inside_of(map, corridor), doorways);
  if (found.empty()) return std::nullopt;
  return *std::min_element(found.begin(), found.end(),
                           [](const Passage& a, const Passage& b) { return a.width_m < b.width_m; });
}

std::string describe(const FreeLoop& loop) {
  std::string rooms;
  for (const auto& room : loop.rooms) rooms += (rooms.empty() ? "" : ", ") + room;
  return decimal(loop.length_m, 1) + " m around " + at(loop.island) + ": " + rooms;
}

}  // namespace

Check check_starts(const Scene& scene, const NavMap& map, double radius_m) {
  Check check{"starts"};
  const auto starts = starts_of(scene, map, radius_m);
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const double distance_m = map.distance_m(starts[i].position);
    least_m = std::min(least_m, distance_m);
    if (distance_m >= radius_m) continue;
    check.verdict = Verdict::kFail;
    check.details.push_back(start_name(scene, i) + " at " + at(starts[i].position) + " is " +
                            (distance_m < 0.0 ? "in an obstacle" : decimal(distance_m, 2) + " m from an obstacle"));
  }
  check.figures = (scene.starts.empty() ? "anywhere" : std::to_string(starts.size()) + " starts") + ", at least " +
                  decimal(least_m, 2) + " m from obstacles";
  return check;
}

Check check_rooms(const Scene& scene, const NavMap& map, double radius_m) {
  Check check{"rooms"};
  const auto starts = starts_of(scene, map, radius_m);
  RoomReach least{"", 0.0, 1.0};
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (const RoomReach& reach : room_reach(map, scene.rooms, starts[i].position, radius_m)) {
      if (reach.reachable_share < least.reachable_share) least = reach;
      if (reach.reachable_share >= kLeastReach) continue;
      check.verdict = Verdict::kFail;
      check.details.push_back(reach.room + " cannot be reached from " + start_name(scene, i) + ": only " +
                              decimal(100.0 * reach.reachable_share, 1) + " % of its floor");
    }
  }
  if (scene.rooms.empty()) return {"rooms", Verdict::kNote, "the scene knows no rooms", {}};
  double area_m2 = 0.0;
  for (const Room& room : scene.rooms) area_m2 += std::abs(signed_area(room.polygon));
  check.figures = std::to_string(scene.rooms.size()) + " rooms, " + decimal(area_m2, 0) + " m2; least is " +
                  decimal(100.0 * least.reachable_share, 0) + " % of the floor of " + least.room;
  return check;
}

Check check_tour(const Scene& scene, const NavMap& map, const TourConfig& config) {
  if (scene.tour.empty()) return {"tour", Verdict::kNote, "the scene has none", {}};
  Check check{"tour"};
  const auto starts = starts_of(scene, map, config.path.radius_m);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    try {
      const Tour tour = plan_tour(map, starts[i].position, scene.tour, config);
      if (!check.figures.empty()) continue;
      check.figures = std::to_string(scene.tour.size()) + " waypoints, " + decimal(tour.length_m, 1) + " m, " +
                      decimal(tour.duration_s, 0) + " s from " + start_name(scene, i);
    } catch (const std::runtime_error& error) {
      check.verdict = Verdict::kFail;
      check.details.push_back(start_name(scene, i) + ": " + error.what());
    }
  }
  if (check.figures.empty()) check.figures = "cannot be driven";
  return check;
}

Check check_doors(const Scene& scene, const NavMap& map) {
  Check check{"doors"};
  const auto found = passages(map, scene.rooms);
  for (const Passage& passage : found) {
    if (!is_narrower(passage.width_m, kLeastWidth_m, map)) continue;
    check.verdict = Verdict::kFail;
    check.details.push_back(passage.from + " - " + passage.to + ": " + decimal(passage.width_m, 2) + " m at " +
                            at(passage.at));
  }
  if (found.empty()) return {"doors", Verdict::kNote, "no two rooms are joined", {}};
  // The widest passages come first.
  const Passage& last = found.back();
  check.figures = std::to_string(found.size()) + " passages join the rooms; the narrowest has " +
                  decimal(last.width_m, 2) + " m (" + last.from + " - " + last.to + ")";
  return check;
}

Check check_corridors(const Scene& scene, const NavMap& map) {
  Check check{"corridors"};
  std::size_t count = 0;
  for (const Room& room : scene.rooms) {
    if (room.type != "hallway" && room.type != "corridor") continue;
    ++count;
    const auto passage = narrowest(map, room);
    if (!passage) {
      check.details.push_back(room.id + ": not measured, it has no two doorways with free floor between them");
      if (check.verdict == Verdict::kOk) check.verdict = Verdict::kNote;
      continue;
    }
    const std::string text = room.id + ": " + decimal(passage->width_m, 2) + " m at " + at(passage->at);
    check.details.push_back(text);
    if (is_narrower(passage->width_m, kLeastWidth_m, map)) {
      check.verdict = Verdict::kFail;
    } else if (is_narrower(passage->width_m, kCorridorWidth_m, map) && check.verdict == Verdict::kOk) {
      check.verdict = Verdict::kNote;
    }
  }
  check.figures = std::to_string(count) + " corridors; below: the narrowest places between their doorways";
  if (count == 0) check.figures = "none";
  return check;
}

std::vector<FreeLoop> long_loops(const Scene& scene, const NavMap& map, double radius_m) {
  auto loops = find_loops(map, scene.rooms, starts_of(scene, map, radius_m).front().position, radius_m);
  std::erase_if(loops, [](const FreeLoop& loop) { return loop.length_m < kLeastLoop_m; });
  return loops;
}

Check list_loops(const Scene& scene, const NavMap& map, double radius_m) {
  Check check{"loops"};
  const auto loops = long_loops(scene, map, radius_m);
  for (const FreeLoop& loop : loops) check.details.push_back(describe(loop));
  check.figures = std::to_string(loops.size()) + " of at least " + decimal(kLeastLoop_m, 0) + " m";
  return check;
}

}  // namespace lapis::simulator
