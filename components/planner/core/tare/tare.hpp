#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct TareConfig {
  double horizon_m = 4.0;     ///< half the edge of the local area around the robot
  double lattice_m = 0.5;     ///< between viewpoints
  double range_m = 3.0;       ///< to which a view covers frontiers
  double min_reward_m = 0.5;  ///< of frontier that a viewpoint has to cover besides the others
  std::int64_t seed = 1;
};

/// What a tour is planned from.
struct TourProblem {
  const PlanningGrid& grid;
  const FrontierMap& frontiers;
  const CostTree& paths;  ///< from the robot's cell
  Pose2 robot;
  double fov_rad = 0.0;  ///< of the camera, horizontally
  PathConfig path;
  ViewpointConfig viewpoints;
  double turn_cost_m_per_rad = 0.0;
  std::span<const LeftAlone> left_alone;     ///< frontiers near these are not to be looked at
  std::span<const FailedView> failed_views;  ///< not to be taken again
  double radius_m = 0.0;                     ///< what lies nearer to such places is meant, too
  std::optional<Pose2> goal;                 ///< that is being driven to
  double keep_factor = 1.0;                  ///< it comes first unless another tour is so much shorter
};

struct TourStop {
  std::uint32_t frontier = 0;  ///< of the viewpoint's target; others may be seen from there, too
  Viewpoint viewpoint;
};

struct Tour {
  std::vector<TourStop> stops;                              ///< in the order in which to visit them
  std::size_t local_stops = 0;                              ///< so many of them are within the horizon
  std::vector<std::pair<std::uint32_t, Rejection>> missed;  ///< frontiers that it leaves out, and why
};

/// Exploration in two levels [Cao, Zhu, Choset & Zhang 2021, TARE], for a camera with a heading where TARE has a lidar
/// that sees all around. Local: viewpoints on a lattice of cells and eight headings; a random choice (seeded) by
/// diminishing reward, the length of frontier that a viewpoint covers and none before it; the shortest of ten tours
/// through such choices. Global: what no local viewpoint covers is visited afterwards, sub-space by sub-space, in a
/// coarse tour whose first one the local tour ends towards.
/// Other than TARE: what the map knows counts as covered, so only frontiers are left to cover; sub-spaces have no state
/// of their own, and small rewards come last rather than never.
Tour plan_tour(const TourProblem& problem, const TareConfig& config);

}  // namespace lapis::planner
