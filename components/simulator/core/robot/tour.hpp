#pragma once

#include <vector>

#include <Eigen/Core>

#include "simulator/core/robot/path_planner.hpp"

namespace lapis::simulator {

struct TourConfig {
  PathConfig path;
  double max_speed_m_s = 0.5;
  double max_turn_rate_rad_s = 0.6;  ///< slow enough for the camera to see rooms
  double lookahead_m = 0.40;
};

/// The path to one waypoint.
struct TourLeg {
  Path path;
  bool stops = false;  ///< the robot stops at its end: to turn sharply, or because the tour ends
};

struct Tour {
  std::vector<TourLeg> legs;
  double length_m = 0.0;
  double duration_s = 0.0;  ///< estimate
};

/// Plans a tour over all waypoints [m] in their order.
/// @throws std::runtime_error naming the waypoint (the first is number 1) that cannot be reached from the one before.
Tour plan_tour(const NavMap& map, const Eigen::Vector2d& start, const std::vector<Eigen::Vector2d>& waypoints,
               const TourConfig& config);

/// Greatest speed of a tour at this distance of the robot's centre from obstacles: lower in narrow places.
double speed_limit_m_s(const TourConfig& config, double distance_m);

}  // namespace lapis::simulator
