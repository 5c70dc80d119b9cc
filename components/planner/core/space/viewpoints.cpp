#include "planner/core/space/viewpoints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/mapping/model/voxel_index.hpp"
#include "planner/core/space/line.hpp"

namespace lapis::planner {
namespace {

struct RingCell {
  std::uint64_t rank;  ///< cells are taken in the order of their rank
  Cell cell;
  auto operator<=>(const RingCell&) const = default;
};

std::uint64_t draw(std::uint64_t seed, Cell c) {
  const auto x = static_cast<std::uint32_t>(c.x), y = static_cast<std::uint32_t>(c.y);
  return mapping::mix_bits(mapping::mix_bits(seed) ^ (std::uint64_t{y} << 32 | x));
}

/// Index of the sector, of `count` around `middle`, in which a cell lies.
std::size_t sector_of(Cell c, Cell middle, std::size_t count) {
  const double turns = 0.5 + std::atan2(c.y - middle.y, c.x - middle.x) / (2.0 * std::numbers::pi);
  return std::min(count - 1, static_cast<std::size_t>(turns * static_cast<double>(count)));
}

/// Cells of the ring that can be reached, in the order of their rank; sets `lack` to what the best cells lack.
std::vector<RingCell> reachable_ring(const PlanningGrid& grid, const CostTree& paths, Cell target,
                                     const ViewpointConfig& config, Rejection& lack) {
  std::vector<RingCell> ring;
  const double low = config.min_distance_m / grid.resolution_m(), high = config.max_distance_m / grid.resolution_m();
  const int reach = static_cast<int>(high);
  for (Cell step{0, -reach}; step.y <= reach; ++step.y) {
    for (step.x = -reach; step.x <= reach; ++step.x) {
      const Cell c = target + step;
      if (distance(c, target) < low || distance(c, target) > high || !grid.is_traversable(c)) continue;
      lack = std::max(lack, Rejection::kUnreachable);
      if (!paths.cost_m(c)) continue;
      const auto rank = config.nearest_first ? static_cast<std::uint64_t>(squared_distance(c, target))
                                             : draw(static_cast<std::uint64_t>(config.seed), c);
      ring.push_back({rank, c});
    }
  }
  std::sort(ring.begin(), ring.end());
  return ring;
}

std::vector<Viewpoint> one_per_sector(const PlanningGrid& grid, const CostTree& paths, Cell target,
                                      const std::vector<RingCell>& ring, int sectors, Sight sight) {
  std::vector<bool> is_filled(static_cast<std::size_t>(sectors), false);
  std::vector<Viewpoint> viewpoints;
  for (const RingCell& candidate : ring) {
    const Cell c = candidate.cell;
    const std::size_t sector = sector_of(c, target, is_filled.size());
    if (is_filled[sector] || (sight == Sight::kNeeded && !is_in_sight(grid, c, target))) continue;
    is_filled[sector] = true;
    const double yaw_rad = std::atan2(target.y - c.y, target.x - c.x);
    viewpoints.push_back({c, {grid.center_of(c), yaw_rad}, target, *paths.cost_m(c)});
  }
  return viewpoints;
}

/// True when two places lie in about the same direction from `middle`.
bool is_same_side(const Eigen::Vector2d& middle, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  constexpr double kSide_cos = 0.5;  // of 60 degrees
  return (a - middle).dot(b - middle) >= kSide_cos * (a - middle).norm() * (b - middle).norm();
}

}  // namespace

Rejection why_left_alone(std::span<const LeftAlone> left_alone, const Eigen::Vector2d& target_map,
                         const std::optional<Eigen::Vector2d>& from_map, double radius_m) {
  Rejection reason = Rejection::kNone;
  for (const LeftAlone& place : left_alone) {
    const bool is_meant = !place.side_map || (from_map && is_same_side(place.target_map, *place.side_map, *from_map));
    if (is_meant && (place.target_map - target_map).norm() <= radius_m) reason = std::max(reason, place.reason);
  }
  return reason;
}

bool is_failed_view(std::span<const FailedView> failed_views, const Eigen::Vector2d& target_map,
                    const Eigen::Vector2d& from_map, double radius_m) {
  return std::any_of(failed_views.begin(), failed_views.end(), [&](const FailedView& view) {
    return (view.target_map - target_map).norm() <= radius_m && (view.from_map - from_map).norm() <= radius_m;
  });
}

bool is_in_sight(const PlanningGrid& grid, Cell from, Cell to) {
  return walk_line(from, to, [&](Cell c, double) { return grid.state(c) != mapping::kOccupied; });
}

ViewpointResult sample_viewpoints(const PlanningGrid& grid, const CostTree& paths, const Frontier& frontier,
                                  const ViewpointConfig& config, Sight sight) {
  ViewpointResult result;
  for (const Cell& target : frontier.representatives) {
    const std::vector<RingCell> ring = reachable_ring(grid, paths, target, config, result.rejection);
    if (ring.empty()) continue;
    result.rejection = Rejection::kHidden;
    result.viewpoints = one_per_sector(grid, paths, target, ring, config.max_per_frontier, sight);
    if (result.viewpoints.empty()) continue;
    result.rejection = Rejection::kNone;
    break;
  }
  return result;
}

}  // namespace lapis::planner
