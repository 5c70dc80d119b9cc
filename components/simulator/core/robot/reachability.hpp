#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/path_planner.hpp"

namespace lapis::simulator {

/// How much of a room the robot can get to.
struct RoomReach {
  std::string room;
  double area_m2 = 0.0;          ///< of its polygon
  double reachable_share = 0.0;  ///< of that area, for the robot's centre; furniture counts as area
};

/// @param start of the robot; @param radius_m of the robot
std::vector<RoomReach> room_reach(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                  double radius_m);

/// The narrowest place on the widest path between two rooms (or groups of rooms).
struct Passage {
  std::string from, to;      ///< on each side, the room whose open middle lies nearest
  double width_m = 0.0;      ///< diameter of the largest disc that passes; up to two cells too small
  Eigen::Vector2d at{0, 0};  ///< [m]
};

/// Joins rooms in the order of decreasing width, so that n rooms of one building give n - 1 passages and the narrowest
/// one on the path between any two is the last that was needed to join them (a maximum spanning tree). A room stands
/// for its place farthest from obstacles. Rooms that no disc can move between have no passage.
std::vector<Passage> passages(const NavMap& map, const std::vector<Room>& rooms);

/// A path around obstacles that returns to where it began.
struct FreeLoop {
  Eigen::Vector2d island{0, 0};    ///< a middle of the obstacles that it goes around [m]
  double island_area_m2 = 0.0;     ///< in which the robot's centre cannot be
  double length_m = 0.0;           ///< shortest; up to 8 % too long where it runs neither straight nor diagonally
  std::vector<std::string> rooms;  ///< that it passes, in their order along it
  Path path;                       ///< closed: the first point is the last
};

/// The shortest loop around each island: obstacles that touch each other (for this radius) but not the outside, larger
/// than `least_area_m2`. Longest loop first.
std::vector<FreeLoop> find_loops(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                 double radius_m, double least_area_m2 = 1.0);

}  // namespace lapis::simulator
