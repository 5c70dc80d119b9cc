#pragma once

#include <string>
#include <utility>
#include <vector>

#include "simulator/core/generator/building_plan.hpp"
#include "simulator/core/looks/dice.hpp"

namespace lapis::simulator {

/// A length rounded to whole centimetres [m].
double cm(double length_m);

/// A strip along a corridor that is divided among rooms.
struct Strip {
  Eigen::Vector2d begin{0, 0};  ///< where the first room's wall on the corridor's side begins
  Eigen::Vector2d along{1, 0};  ///< unit vector along the corridor
  Eigen::Vector2d away{0, 1};   ///< unit vector away from the corridor
  double length_m = 0.0, depth_m = 0.0;
  bool has_windows = true;  ///< the wall opposite the corridor is an outer wall
};

/// A room of a strip, and its width in proportion to the other rooms.
struct StripRoom {
  RoomUse use = RoomUse::kOffice;
  double share_m = 3.0;
};

/// Adds rooms and openings to a plan, step by step.
class FloorDrawing {
 public:
  FloorDrawing(BuildingPlan& plan, Dice& dice) : plan_(plan), dice_(dice) {}

  /// Divides the strip among the rooms in the given proportions; each has a door to the corridor. With `makes_copies`,
  /// neighbours of the same use and width are copies of each other, and every other one is mirrored. Returns the
  /// indices of the rooms.
  std::vector<std::size_t> add_strip(const Strip& strip, std::vector<StripRoom> rooms, bool makes_copies);
  /// As many rooms of about `width_m` as fit into `length_m`, with the uses in turn.
  std::vector<StripRoom> filled(double length_m, double width_m, const std::vector<RoomUse>& uses) const;
  std::size_t add_room(RoomUse use, const RoomFrame& frame, Polygon polygon);
  std::size_t add_rectangle(RoomUse use, const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  void add_opening(OpeningKind kind, const Eigen::Vector2d& at, double width_m);
  /// Adds a window in the middle of an outer wall, or two in a long one.
  void add_windows(const PlannedRoom& room, std::size_t wall);
  /// Adds a door in the wall between two neighbours of a strip. @param second the one farther along
  void join(std::size_t first, std::size_t second, const Strip& strip);

 private:
  PlannedRoom& place(const Strip& strip, RoomUse use, double from_m, double width_m, bool is_mirrored);
  void add_door(const PlannedRoom& room, double along_m);

  BuildingPlan& plan_;
  Dice& dice_;
};

}  // namespace lapis::simulator
