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
  double lattice_m = 0.5;     ///< spacing of the viewpoints
  double range_m = 3.0;       ///< up to which a view covers frontiers
  double min_reward_m = 0.5;  ///< least length of frontier that a viewpoint has to cover in addition to the others
  std::int64_t seed = 1;
};

/// The input of a tour.
struct TourProblem {
  const PlanningGrid& grid;
  const FrontierMap& frontiers;
  const CostTree& paths;  ///< rooted at the robot's cell
  Pose2 robot;
  double fov_rad = 0.0;  ///< horizontal field of view of the camera
  PathConfig path;
  ViewpointConfig viewpoints;
  double turn_cost_m_per_rad = 0.0;
  std::span<const LeftAlone> left_alone;     ///< targets of frontiers that must not be viewed
  std::span<const FailedView> failed_views;  ///< views that must not be taken again
  double radius_m = 0.0;                     ///< radius within which these apply to other positions, too
  std::optional<Pose2> goal;                 ///< the current goal
  double keep_factor = 1.0;                  ///< the goal comes first unless another tour is this factor shorter
};

struct TourStop {
  std::uint32_t frontier = 0;  ///< of the viewpoint's target; other frontiers may be visible from there, too
  Viewpoint viewpoint;
};

struct Tour {
  std::vector<TourStop> stops;                              ///< in the order of the tour
  std::size_t local_stops = 0;                              ///< number of the first stops, which are in the local area
  std::vector<std::pair<std::uint32_t, Rejection>> missed;  ///< frontiers without a stop, and why
};

/// Exploration on two levels [Cao, Zhu, Choset & Zhang 2021, TARE], for a camera with a heading, where TARE has a lidar
/// that sees all around. Local level: viewpoints are on a lattice of cells and have eight headings. They are drawn at
/// random (seeded) by diminishing reward, which is the length of frontier that a viewpoint covers and none before it
/// does; of ten tours through such choices, the shortest is taken. Global level: frontiers that no local viewpoint
/// covers are visited afterwards, sub-space by sub-space, in a coarse tour, and the local tour ends at its first stop.
/// Differences from TARE: what the map knows counts as covered, so that only frontiers have to be covered; sub-spaces
/// have no state of their own; and small rewards come last instead of never.
Tour plan_tour(const TourProblem& problem, const TareConfig& config);

}  // namespace lapis::planner
