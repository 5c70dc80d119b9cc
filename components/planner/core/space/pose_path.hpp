#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {

/// The cheapest path of poses from the robot to a place, or to the nearest reachable cell within 1 m of a place that
/// cannot be reached. Empty when there is none.
/// @param spacing_m largest distance between poses
std::vector<Pose2> pose_path_to(const Pose2& place, const Pose2& robot, const PlanningGrid& grid,
                                const PathConfig& config, double spacing_m);

/// True when the rest of the path leads over passable cells. The first metre from the robot does not matter: the robot
/// may stand in what the map shows as an obstacle, and the controller sees what lies just ahead.
bool is_path_free(std::span<const Pose2> path, const Pose2& robot, const PlanningGrid& grid);

/// Position on the path of whatever stops the robot [m, map]; empty at the path's end.
std::optional<Eigen::Vector2d> place_ahead(std::span<const Pose2> path, const Pose2& robot);

}  // namespace lapis::planner
