#pragma once

#include <span>
#include <vector>

#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

enum class PathStatus {
  kFound,
  kGoalNotTraversable,  ///< occupied, unknown, or too near to an obstacle
  kNoPath,              ///< the goal cannot be reached
};

/// A path on the grid.
struct Path {
  std::vector<Cell> cells;  ///< corners: the path is straight between their centres
  double length_m = 0.0;
  double cost_m = 0.0;  ///< integral of cost_per_metre along the lines
};

struct PathResult {
  PathStatus status = PathStatus::kNoPath;
  Path path;  ///< empty unless found
};

/// The cheapest path from one cell to another, straightened.
PathResult find_path(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to);

/// Straightens a path of cells from a CostTree: lines replace cells wherever a line costs no more than the cells (0.1 %
/// tolerance) and touches only passable cells. The first cells of a robot that leaves a place that is not traversable
/// stay as they are.
Path straightened(const PlanningGrid& grid, const PathConfig& config, std::span<const Cell> cells);

/// Poses along the straight lines between `points` [m, map frame], both ends included. They are equally spaced along
/// the path, by at most `spacing_m`, and head along the line that follows; the last pose has `final_yaw_rad`.
/// @param points at least one
std::vector<Pose2> poses_along(std::span<const Eigen::Vector2d> points, double spacing_m, double final_yaw_rad);

/// Centres of the path's corners [m, map frame].
std::vector<Eigen::Vector2d> points_of(const PlanningGrid& grid, const Path& path);

/// The path with the intermediate headings through which the robot turns, at the start from `yaw_rad` and at corners:
/// the shorter way round, in steps of at most `step_rad`.
std::vector<Pose2> with_turns(std::span<const Pose2> path, double yaw_rad, double step_rad);

}  // namespace lapis::planner
