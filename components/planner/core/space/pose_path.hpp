#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {

/// The cheapest path of poses from the robot to a place; where that cannot be reached, to what can be within 1 m of it.
/// Empty when there is none.
/// @param spacing_m at most, between poses
std::vector<Pose2> pose_path_to(const Pose2& place, const Pose2& robot, const PlanningGrid& grid,
                                const PathConfig& config, double spacing_m);

/// Whether what is left of the path leads over passable cells. The first metre from the robot does not matter: it
/// may stand in what the map takes for an obstacle, and the controller sees what lies just ahead.
bool is_path_free(std::span<const Pose2> path, const Pose2& robot, const PlanningGrid& grid);

/// Where on the path that stands which stops the robot [m, map]; nothing at its end.
std::optional<Eigen::Vector2d> place_ahead(std::span<const Pose2> path, const Pose2& robot);

}  // namespace lapis::planner
