#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/path_planner.hpp"

namespace lapis::simulator {

/// The share of a room that the robot can reach.
struct RoomReach {
  std::string room;
  double area_m2 = 0.0;          ///< of its polygon
  double reachable_share = 0.0;  ///< of that area, for the robot's centre; furniture counts as area
};

/// Reach of each room. @param start of the robot [m]; @param radius_m of the robot
std::vector<RoomReach> room_reach(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                  double radius_m);

/// The narrowest place on the widest path between two rooms (or groups of rooms).
struct Passage {
  std::string from, to;      ///< on each side, the nearest room by its most open place
  double width_m = 0.0;      ///< diameter of the largest disc that passes; up to two cells too small
  Eigen::Vector2d at{0, 0};  ///< [m]
};

/// Joins rooms in the order of decreasing width, so that n rooms of one building give n - 1 passages, and the narrowest
/// one on the path between any two rooms is the last that was needed to join them (a maximum spanning tree). A room is
/// represented by its place farthest from obstacles. Rooms between which no disc can move have no passage.
std::vector<Passage> passages(const NavMap& map, const std::vector<Room>& rooms);

/// A path around obstacles that returns to where it began.
struct FreeLoop {
  Eigen::Vector2d island{0, 0};    ///< centroid of the obstacles that it goes around [m]
  double island_area_m2 = 0.0;     ///< area in which the robot's centre cannot be
  double length_m = 0.0;           ///< up to 8 % too long where it runs neither straight nor diagonally
  std::vector<std::string> rooms;  ///< rooms that it passes, in their order along it
  Path path;                       ///< closed: the first point is also the last
};

/// The shortest loop around each island, the longest loop first. An island is a group of obstacles that are joined for
/// a robot of this radius, do not touch the outside, and are larger than `least_area_m2`.
std::vector<FreeLoop> find_loops(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                 double radius_m, double least_area_m2 = 1.0);

}  // namespace lapis::simulator
