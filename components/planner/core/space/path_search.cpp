#include "planner/core/space/path_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

namespace lapis::planner {

double cost_per_metre(const PlanningGrid& grid, const PathConfig& config, Cell c) {
  const double least_m = grid.required_clearance_m(), clearance_m = grid.clearance_m(c);
  if (clearance_m >= config.comfort_m) return 1.0;
  const double nearness = std::min(1.0, (config.comfort_m - clearance_m) / (config.comfort_m - least_m));
  return 1.0 + config.nearness_weight * nearness * nearness;
}

std::optional<double> CostTree::cost_m(Cell c) const {
  const Node& node = nodes_.at(c);
  if (!node.is_final) return std::nullopt;
  return node.cost;
}

std::vector<Cell> CostTree::path_to(Cell to) const {
  std::vector<Cell> path;
  if (!nodes_.at(to).is_final) return path;
  for (Cell c = to;; c = c - kSteps[nodes_.at(c).step]) {
    path.push_back(c);
    if (nodes_.at(c).step == kRoot) break;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

/// A single run of the search.
class PathSearch {
 public:
  PathSearch(const PlanningGrid& grid, const PathConfig& config, const PathQuery& query)
      : grid_(grid), config_(config), query_(query) {}

  CostTree run() {
    offer(query_.from, 0.0, CostTree::kRoot);
    while (!open_.empty()) {
      const Cell c = open_.top().second;
      open_.pop();
      CostTree::Node& node = tree_.nodes_[c];
      if (node.is_final) continue;
      node.is_final = true;
      tree_.reached_.push_back(c);
      if (query_.to == c) break;
      expand(c, node.cost);
    }
    return std::move(tree_);
  }

 private:
  using Entry = std::pair<double, Cell>;  // cost from the root plus the lower bound to the goal

  double rate(Cell c) const {
    const double surcharge = query_.surcharge != nullptr ? static_cast<double>(query_.surcharge->at(c)) : 0.0;
    return cost_per_metre(grid_, config_, c) + surcharge;
  }

  /// Lower bound of the cost to the goal: length of the shortest path on an empty grid [m].
  double least_cost(Cell c) const {
    if (!query_.to) return 0.0;
    const double x = std::abs(c.x - query_.to->x), y = std::abs(c.y - query_.to->y);
    return grid_.resolution_m() * (std::max(x, y) + (std::numbers::sqrt2 - 1.0) * std::min(x, y));
  }

  bool may_enter(Cell from, Cell to) const {
    if (grid_.is_passable(to)) return true;
    return !grid_.is_traversable(from) && grid_.state(to) != mapping::kOccupied &&
           distance(to, query_.from) * grid_.resolution_m() <= config_.escape_m &&
           (grid_.has_room(to) || grid_.clearance_m(to) >= grid_.clearance_m(from));
  }

  void expand(Cell c, double cost) {
    const double rate_here = rate(c);
    std::array<bool, kStraightSteps> is_open;
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
      const Cell next = c + kSteps[i];
      const bool is_diagonal = i >= kStraightSteps;
      if (is_diagonal) {
        if (!is_open[i - kStraightSteps] || !is_open[(i + 1) % kStraightSteps] || !may_enter(c, next)) continue;
      } else {
        is_open[i] = may_enter(c, next);
        if (!is_open[i]) continue;
      }
      if (tree_.nodes_.at(next).is_final) continue;
      const double length = grid_.resolution_m() * (is_diagonal ? std::numbers::sqrt2 : 1.0);
      offer(next, cost + length * 0.5 * (rate_here + rate(next)), static_cast<std::uint8_t>(i));
    }
  }

  void offer(Cell c, double cost, std::uint8_t step) {
    if (cost > query_.max_cost_m || cost >= tree_.nodes_.at(c).cost) return;
    tree_.nodes_[c] = {cost, step, false};
    open_.emplace(cost + least_cost(c), c);
  }

  const PlanningGrid& grid_;
  const PathConfig& config_;
  const PathQuery& query_;
  CostTree tree_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

CostTree grow_cost_tree(const PlanningGrid& grid, const PathConfig& config, const PathQuery& query) {
  return PathSearch(grid, config, query).run();
}

}  // namespace lapis::planner
