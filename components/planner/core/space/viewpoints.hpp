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
  double min_distance_m = 0.5;  ///< from the cell of the frontier that is viewed
  double max_distance_m = 2.0;  ///< larger than min_distance_m; at most the sensor's range
  int max_per_frontier = 8;
  bool nearest_first = false;  ///< prefers places near the viewed cell; false: places are drawn at random
  std::int64_t seed = 1;
};

/// A place from which to view a frontier.
struct Viewpoint {
  Cell cell;
  Pose2 pose;           ///< at the cell's centre, heading towards the viewed cell
  Cell target;          ///< one of the frontier's representatives
  double cost_m = 0.0;  ///< of the path to it
};

/// A target that is still a frontier although it was viewed from `from_map` [m, map].
struct FailedView {
  Eigen::Vector2d target_map, from_map;

  bool operator==(const FailedView&) const = default;
};

/// A target that must not be viewed [m, map].
struct LeftAlone {
  Eigen::Vector2d target_map;
  Rejection reason = Rejection::kLeftAlone;
  /// If set, the target must not be viewed from the side on which this position lies; other sides are allowed.
  std::optional<Eigen::Vector2d> side_map = std::nullopt;

  bool operator==(const LeftAlone&) const = default;
};

/// Why a target is left alone; kNone when it is not. Of several entries near the target, the reason that is last in the
/// enumeration counts.
/// @param from_map position from which it would be viewed; if empty, only targets that are left alone from all sides
/// count
Rejection why_left_alone(std::span<const LeftAlone> left_alone, const Eigen::Vector2d& target_map,
                         const std::optional<Eigen::Vector2d>& from_map, double radius_m);

/// True when a view of the target from about the same place has failed: another one shows no more, but one from
/// elsewhere may.
bool is_failed_view(std::span<const FailedView> failed_views, const Eigen::Vector2d& target_map,
                    const Eigen::Vector2d& from_map, double radius_m);

/// True when no occupied cell lies between two cells; unknown cells may.
bool is_in_sight(const PlanningGrid& grid, Cell from, Cell to);

enum class Sight {
  kNeeded,     ///< the target has to be in sight
  kNotNeeded,  ///< the obstacle may not exist: a door can look closed from afar
};

struct ViewpointResult {
  Rejection rejection = Rejection::kNoRoom;  ///< kNone when there are viewpoints; otherwise what the best places lacked
  std::vector<Viewpoint> viewpoints;
};

/// Viewpoints in the ring around the first representative of the frontier that has any: at most one in each of
/// max_per_frontier equal sectors. In each sector, the viewpoint is drawn at random (seeded), or is the one nearest to
/// the viewed cell, among the cells that are traversable, reached by `paths` and, if sight is needed, see the target
/// through free and unknown cells. All cells of the ring are tried before a sector stays empty.
ViewpointResult sample_viewpoints(const PlanningGrid& grid, const CostTree& paths, const Frontier& frontier,
                                  const ViewpointConfig& config, Sight sight = Sight::kNeeded);

}  // namespace lapis::planner
