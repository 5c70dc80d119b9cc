#include "planner/core/space/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "planner/core/space/line.hpp"

namespace lapis::planner {
namespace {

constexpr double kSlack = 1.001;  // a line may cost this factor more than the cells that it replaces
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Cost of a straight line; infinite when it touches a cell that is not passable.
double line_cost(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to) {
  double rate = 0.0;  // mean cost per metre along the line
  const bool is_open = walk_line(from, to, [&](Cell c, double share) {
    if (!grid.is_passable(c)) return false;
    rate += share * cost_per_metre(grid, config, c);
    return true;
  });
  return is_open ? rate * distance(from, to) * grid.resolution_m() : kInfinity;
}

/// Cost of a step, as in the search.
double step_cost(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to) {
  const double rate = 0.5 * (cost_per_metre(grid, config, from) + cost_per_metre(grid, config, to));
  return rate * distance(from, to) * grid.resolution_m();
}

}  // namespace

Path straightened(const PlanningGrid& grid, const PathConfig& config, std::span<const Cell> cells) {
  Path path;
  if (cells.empty()) return path;
  path.cells.push_back(cells.front());
  for (std::size_t i = 0; i + 1 < cells.size();) {
    std::size_t best = i + 1;
    double along = step_cost(grid, config, cells[i], cells[best]);
    double cost = along;
    for (std::size_t j = best + 1; j < cells.size(); ++j) {
      along += step_cost(grid, config, cells[j - 1], cells[j]);
      const double line = line_cost(grid, config, cells[i], cells[j]);
      if (line > kSlack * along) break;
      best = j;
      cost = line;
    }
    path.cells.push_back(cells[best]);
    path.length_m += distance(cells[i], cells[best]) * grid.resolution_m();
    path.cost_m += cost;
    i = best;
  }
  return path;
}

PathResult find_path(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to) {
  if (!grid.is_traversable(to)) return {PathStatus::kGoalNotTraversable, {}};
  const CostTree tree = grow_cost_tree(grid, config, {from, to});
  if (!tree.cost_m(to)) return {PathStatus::kNoPath, {}};
  return {PathStatus::kFound, straightened(grid, config, tree.path_to(to))};
}

std::vector<Eigen::Vector2d> points_of(const PlanningGrid& grid, const Path& path) {
  std::vector<Eigen::Vector2d> points;
  for (const Cell& c : path.cells) points.push_back(grid.center_of(c));
  return points;
}

std::vector<Pose2> poses_along(std::span<const Eigen::Vector2d> points, double spacing_m, double final_yaw_rad) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  const double intervals = std::ceil(length / spacing_m - 1e-9);
  std::vector<Pose2> poses;
  double begin = 0.0;  // begin of the line, along the path
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d line = points[i] - points[i - 1];
    const double end = begin + line.norm(), yaw = std::atan2(line.y(), line.x());
    for (auto n = static_cast<double>(poses.size()); n < intervals && length * n / intervals < end; n += 1.0)
      poses.push_back({points[i - 1] + line * ((length * n / intervals - begin) / line.norm()), yaw});
    begin = end;
  }
  poses.push_back({points.back(), final_yaw_rad});
  return poses;
}

std::vector<Pose2> with_turns(std::span<const Pose2> path, double yaw_rad, double step_rad) {
  std::vector<Pose2> poses;
  for (const Pose2& pose : path) {
    const double turn_rad = std::remainder(pose.yaw_rad - yaw_rad, 2.0 * std::numbers::pi);
    const double steps = std::ceil(std::abs(turn_rad) / step_rad - 1e-9);
    for (double i = 1.0; i < steps; i += 1.0) poses.push_back({pose.p_map, yaw_rad + turn_rad * i / steps});
    poses.push_back(pose);
    yaw_rad = pose.yaw_rad;
  }
  return poses;
}

}  // namespace lapis::planner
