#include "planner/core/space/pose_path.hpp"

#include <algorithm>

namespace lapis::planner {
namespace {

constexpr double kAhead_m = 0.35;         // distance ahead of the robot at which an obstruction is assumed
constexpr double kNearEnough_m = 1.0;     // accepted distance from a place that cannot be reached
constexpr double kPathTolerance_m = 1.0;  // nearer to the robot, obstacles on the path are ignored

double distance(const Pose2& a, const Pose2& b) { return (a.p_map - b.p_map).norm(); }

// The nearest cell that can be reached. The place itself may be out of reach, such as a start of the mission beside a
// wall.
std::optional<Cell> nearest_reached(const PlanningGrid& grid, const CostTree& tree, const Eigen::Vector2d& place_map) {
  const Cell middle = grid.cell_of(place_map);
  const int reach = static_cast<int>(kNearEnough_m / grid.resolution_m());
  std::optional<Cell> nearest;
  for (Cell step{0, -reach}; step.y <= reach; ++step.y) {
    for (step.x = -reach; step.x <= reach; ++step.x) {
      const Cell c = middle + step;
      if (tree.cost_m(c) && (!nearest || distance(c, middle) < distance(*nearest, middle))) nearest = c;
    }
  }
  return nearest;
}

auto nearest_pose(std::span<const Pose2> path, const Pose2& robot) {
  return std::min_element(path.begin(), path.end(),
                          [&](const Pose2& a, const Pose2& b) { return distance(robot, a) < distance(robot, b); });
}

}  // namespace

std::vector<Pose2> pose_path_to(const Pose2& place, const Pose2& robot, const PlanningGrid& grid,
                                const PathConfig& config, double spacing_m) {
  const CostTree tree = grow_cost_tree(grid, config, {grid.cell_of(robot.p_map)});
  const auto end = nearest_reached(grid, tree, place.p_map);
  if (!end) return {};
  std::vector<Eigen::Vector2d> points = points_of(grid, straightened(grid, config, tree.path_to(*end)));
  points.front() = robot.p_map;
  if (*end == grid.cell_of(place.p_map)) points.back() = place.p_map;
  return poses_along(points, spacing_m, place.yaw_rad);
}

bool is_path_free(std::span<const Pose2> path, const Pose2& robot, const PlanningGrid& grid) {
  return std::all_of(nearest_pose(path, robot), path.end(), [&](const Pose2& pose) {
    return distance(robot, pose) < kPathTolerance_m || grid.is_passable(grid.cell_of(pose.p_map));
  });
}

std::optional<Eigen::Vector2d> place_ahead(std::span<const Pose2> path, const Pose2& robot) {
  const auto place = std::find_if(nearest_pose(path, robot), path.end(),
                                  [&](const Pose2& pose) { return distance(robot, pose) >= kAhead_m; });
  if (place == path.end()) return std::nullopt;
  return place->p_map;
}

}  // namespace lapis::planner
