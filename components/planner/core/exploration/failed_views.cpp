#include "planner/core/exploration/failed_views.hpp"

#include <algorithm>

namespace lapis::planner {
namespace {

bool has_frontier_at(const Surroundings& surroundings, bool counts_awaited, const Eigen::Vector2d& target_map) {
  const PlanningGrid& grid = surroundings.grid();
  const auto& frontiers = surroundings.frontiers().frontiers();
  return std::any_of(frontiers.begin(), frontiers.end(), [&](const auto& entry) {
    const auto& cells = entry.second.cells;
    if (!counts_awaited && surroundings.is_awaited(entry.second)) return false;
    return std::any_of(cells.begin(), cells.end(),
                       [&](Cell c) { return (grid.center_of(c) - target_map).norm() <= grid.resolution_m(); });
  });
}

}  // namespace

void FailedViews::await(const FailedView& view, time::Time due) {
  const auto later =
      std::find_if(awaited_.begin(), awaited_.end(), [&](const Awaited& other) { return other.due > due; });
  awaited_.insert(later, {view, due});
}

std::vector<FailedView> FailedViews::judge(const Surroundings& surroundings, bool counts_awaited, time::Time now) {
  std::vector<FailedView> failed;
  const auto later =
      std::find_if(awaited_.begin(), awaited_.end(), [&](const Awaited& awaited) { return awaited.due > now; });
  for (auto due = awaited_.begin(); due != later; ++due) {
    if (has_frontier_at(surroundings, counts_awaited, due->view.target_map)) failed.push_back(due->view);
  }
  awaited_.erase(awaited_.begin(), later);
  failed_.insert(failed_.end(), failed.begin(), failed.end());
  return failed;
}

void FailedViews::forget(const Eigen::Vector2d& target_map, double radius_m) {
  std::erase_if(failed_, [&](const FailedView& view) { return (view.target_map - target_map).norm() <= radius_m; });
}

void FailedViews::clear() {
  awaited_.clear();
  failed_.clear();
}

}  // namespace lapis::planner
