#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/robot/nav_map.hpp"

namespace lapis::simulator {

using Path = std::vector<Eigen::Vector2d>;

double length_m(const Path& path);

struct PathConfig {
  double radius_m = 0.20;        ///< of the robot
  double margin_m = 0.05;        ///< additional clearance
  double resolution_m = 0.05;    ///< of the cells that are searched
  double comfort_m = 0.30;       ///< gap between disc and obstacle from which on nearness costs nothing
  double nearness_weight = 2.0;  ///< a metre of path that touches obstacles costs 1 + this
};

/// Shortest paths that prefer to keep away from obstacles: A* over 8 neighbours, then shortened where a straight line
/// costs no more.
class PathPlanner {
 public:
  /// @param map must outlive the planner.
  PathPlanner(const NavMap& map, const PathConfig& config);

  /// Path whose first point is `from`, and whose last is `to` or, when that is too close to an obstacle, the nearest
  /// place that is not. Nothing when there is no path, or when one of the ends is more than 0.15 m from such a place.
  std::optional<Path> plan(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// Centre of the nearest free cell, if there is one within 0.15 m.
  std::optional<Eigen::Vector2d> nearest_free(const Eigen::Vector2d& p) const;

 private:
  bool is_free(const Eigen::Vector2d& p) const;
  double cost_per_metre(const Eigen::Vector2d& p) const;
  double segment_cost(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  Path search(Cell from, Cell to) const;
  Path shorten(const Path& path) const;

  const NavMap* map_;
  PathConfig config_;
  Grid grid_;
  geometry::GrayImage free_;
  geometry::Image<double> cost_;  ///< per metre, at the centre of each cell
};

/// A coarser grid over the same area.
Grid coarsened(const Grid& grid, double resolution_m);

/// 255 for the cells of `grid` whose centre is at least `radius_m` from every obstacle, else 0.
geometry::GrayImage free_cells(const NavMap& map, const Grid& grid, double radius_m);

}  // namespace lapis::simulator
