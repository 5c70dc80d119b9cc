#include "planner/core/candidates/gap_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace lapis::planner {
namespace {

constexpr int kGapHeadings = 8;
constexpr int kCoarseColumns = 16, kCoarseRows = 9;  // number of rays of a coarse image
constexpr std::size_t kMostViews = 20;               // views that are proposed
constexpr std::size_t kMostLooks = 200;              // views whose information is computed with all rays
constexpr double kAhead_m = 1.0;                     // distance of the target ahead, for memories of targets
constexpr double kOverhead_m = 2.0;                  // cost of a view besides that of its path
constexpr double kSameView_m = 0.5, kSameView_rad = 0.4;

/// For each square of the floor, the reachable cell that is nearest to the middle of the square.
std::vector<Cell> places(const PlanningGrid& grid, const CostTree& tree, double spacing_m) {
  const double edge_cells = std::max(1.0, spacing_m / grid.resolution_m());
  std::map<Cell, std::pair<double, Cell>> nearest;  // by square: distance from its middle [squares], cell
  for (const Cell& c : tree.reached()) {
    if (!grid.is_traversable(c)) continue;
    const Eigen::Vector2d p = Eigen::Vector2d(c.x + 0.5, c.y + 0.5) / edge_cells;
    const Cell square{static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
    const double off = (p - Eigen::Vector2d(square.x + 0.5, square.y + 0.5)).norm();
    const auto [known, is_new] = nearest.try_emplace(square, off, c);
    if (!is_new && std::pair(off, c) < known->second) known->second = {off, c};
  }
  std::vector<Cell> cells;
  for (const auto& entry : nearest) cells.push_back(entry.second.second);
  return cells;
}

std::vector<double> promises(const Situation& s, const View& view, const std::vector<Viewpoint>& viewpoints) {
  std::vector<ViewPath> paths;
  for (const Viewpoint& viewpoint : viewpoints) paths.push_back({camera_at(s, viewpoint.pose)});
  return path_information(s.field, view, std::span<const ViewPath>(paths));
}

/// Sorted by information per cost, the largest first; the current goal comes before all others.
std::vector<Viewpoint> ranked(const Situation& s, const std::vector<Viewpoint>& viewpoints, const Memory& memory) {
  ViewConfig coarse = s.view.config();
  coarse.columns = kCoarseColumns;
  coarse.rows = kCoarseRows;
  const std::vector<double> nats = promises(s, View(coarse), viewpoints);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const bool is_goal = memory.goal && is_taken(viewpoints[i].pose, {&*memory.goal, 1});
    const double worth = nats[i] / (viewpoints[i].cost_m + kOverhead_m);
    order.emplace_back(is_goal ? -std::numeric_limits<double>::infinity() : -worth, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<Viewpoint> sorted;
  for (const auto& entry : order) sorted.push_back(viewpoints[entry.second]);
  return sorted;
}

/// All headings at all places, without places that have failed and views that were taken.
std::vector<Viewpoint> all_views(const Situation& s, const CostTree& tree, const Memory& memory, double spacing_m) {
  std::vector<Viewpoint> views;
  for (const Cell& c : places(s.grid, tree, spacing_m)) {
    const Eigen::Vector2d place_map = s.grid.center_of(c);
    if (why_left_alone(memory.gap_places, place_map, std::nullopt, memory.radius_m) != Rejection::kNone) continue;
    for (int i = 0; i < kGapHeadings; ++i) {
      const double yaw_rad = 2.0 * std::numbers::pi * i / kGapHeadings;
      const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
      const Viewpoint view{c, {place_map, yaw_rad}, s.grid.cell_of(place_map + kAhead_m * ahead), *tree.cost_m(c)};
      if (!is_taken(view.pose, memory.taken_views)) views.push_back(view);
    }
  }
  return views;
}

}  // namespace

bool is_taken(const Pose2& view, std::span<const Pose2> taken) {
  return std::any_of(taken.begin(), taken.end(), [&](const Pose2& other) {
    return (other.p_map - view.p_map).norm() < kSameView_m && turn_between(other.yaw_rad, view.yaw_rad) < kSameView_rad;
  });
}

std::vector<Viewpoint> gap_views(const Situation& s, const CostTree& tree, const Memory& memory,
                                 const GapConfig& config) {
  std::vector<Viewpoint> candidates = ranked(s, all_views(s, tree, memory, config.spacing_m), memory);
  candidates.resize(std::min(candidates.size(), kMostLooks));
  const std::vector<double> nats = promises(s, s.view, candidates);
  std::vector<Viewpoint> views;
  for (std::size_t i = 0; i < candidates.size() && views.size() < kMostViews; ++i) {
    if (nats[i] >= config.least_nats) views.push_back(candidates[i]);
  }
  return views;
}

}  // namespace lapis::planner
