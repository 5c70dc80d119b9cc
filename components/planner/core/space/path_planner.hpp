#pragma once

#include <span>
#include <vector>

#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

enum class PathStatus {
  kFound,
  kGoalNotTraversable,  ///< occupied, unknown, or too near to an obstacle
  kNoPath,              ///< the goal cannot be reached within the bound
};

/// A path through the grid.
struct Path {
  std::vector<Cell> cells;  ///< corners: the path goes straight between their centres
  double length_m = 0.0;
  double cost_m = 0.0;  ///< integral of cost_per_metre along the lines
};

struct PathResult {
  PathStatus status = PathStatus::kNoPath;
  Path path;  ///< empty unless found
};

/// The cheapest path, straightened.
PathResult find_path(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to);

/// Path along cells that a CostTree gave, with straight lines wherever a line costs no more than the cells it replaces
/// (0.1 % allowed) and touches passable cells only. The first cells of a robot that leaves a place that is not
/// traversable stay as they are.
Path straightened(const PlanningGrid& grid, const PathConfig& config, std::span<const Cell> cells);

/// Poses along straight lines between `points` [m, map frame], both ends included, equally spaced by at most
/// `spacing_m` along the path, headed along the line that follows; the last pose has `final_yaw_rad`. At least one
/// point.
std::vector<Pose2> poses_along(std::span<const Eigen::Vector2d> points, double spacing_m, double final_yaw_rad);

/// Centres of the corners [m, map frame].
std::vector<Eigen::Vector2d> points_of(const PlanningGrid& grid, const Path& path);

/// A path and the headings through which a robot turns that begins with another one, and at corners: the shorter way
/// round, at most `step_rad` apart.
std::vector<Pose2> with_turns(std::span<const Pose2> path, double yaw_rad, double step_rad);

}  // namespace lapis::planner
