#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/core/space/frontier_map.hpp"
#include "planner/core/space/path_search.hpp"
#include "planner/core/space/rejection.hpp"

namespace lapis::planner {

struct ViewpointConfig {
  double min_distance_m = 0.5;  ///< from the cell of the frontier that is looked at
  double max_distance_m = 2.0;  ///< above min_distance_m; below the sensor's range
  int max_per_frontier = 8;
  bool nearest_first = false;  ///< to what is looked at; false: drawn at random
  std::int64_t seed = 1;
};

/// A place to look at a frontier from.
struct Viewpoint {
  Cell cell;
  Pose2 pose;           ///< at the cell's centre, headed to the cell that is looked at
  Cell target;          ///< one of the frontier's representatives
  double cost_m = 0.0;  ///< of the path to it
};

/// A target that is a frontier still, although it has been viewed from there [m, map].
struct FailedView {
  Eigen::Vector2d target_map, from_map;

  bool operator==(const FailedView&) const = default;
};

/// A target that is not to be looked at [m, map].
struct LeftAlone {
  Eigen::Vector2d target_map;
  Rejection reason = Rejection::kLeftAlone;
  std::optional<Eigen::Vector2d> side_map = std::nullopt;  ///< only from the side of the target where this lies

  bool operator==(const LeftAlone&) const = default;
};

/// Why a target is left alone, the last of all that are near in the order of the enumeration; kNone: it is not.
/// @param from_map where it would be looked at from; without, only what is left alone from all sides counts
Rejection why_left_alone(std::span<const LeftAlone> left_alone, const Eigen::Vector2d& target_map,
                         const std::optional<Eigen::Vector2d>& from_map, double radius_m);

/// Another view from about the same place shows no more; one from elsewhere may.
bool is_failed_view(std::span<const FailedView> failed_views, const Eigen::Vector2d& target_map,
                    const Eigen::Vector2d& from_map, double radius_m);

/// No occupied cell lies between; unknown ones may.
bool is_in_sight(const PlanningGrid& grid, Cell from, Cell to);

enum class Sight {
  kNeeded,     ///< of the target
  kNotNeeded,  ///< what hides it may not be there: a door can look closed from afar
};

struct ViewpointResult {
  Rejection rejection = Rejection::kNoRoom;  ///< kNone: there are some; else what the best places lacked
  std::vector<Viewpoint> viewpoints;
};

/// Viewpoints in the ring around the first representative of the frontier that has any: at most one in each of
/// max_per_frontier equal sectors, drawn at random (seeded), or the nearest to what is looked at, from all cells of the
/// sector that are traversable, reached by `paths`, and see the target through free and unknown cells, if that is
/// needed. All cells of the ring are tried before one gives up.
ViewpointResult sample_viewpoints(const PlanningGrid& grid, const CostTree& paths, const Frontier& frontier,
                                  const ViewpointConfig& config, Sight sight = Sight::kNeeded);

}  // namespace lapis::planner
