#include "planner/core/exploration/looks.hpp"

#include <algorithm>

namespace lapis::planner {
namespace {

bool has_frontier_at(const Surroundings& surroundings, const Eigen::Vector2d& target_map) {
  const PlanningGrid& grid = surroundings.grid();
  const auto& frontiers = surroundings.frontiers().frontiers();
  return std::any_of(frontiers.begin(), frontiers.end(), [&](const auto& entry) {
    const auto& cells = entry.second.cells;
    return std::any_of(cells.begin(), cells.end(),
                       [&](Cell c) { return (grid.center_of(c) - target_map).norm() <= grid.resolution_m(); });
  });
}

}  // namespace

void Looks::await(const VainLook& look, time::Time due) {
  const auto later =
      std::find_if(awaited_.begin(), awaited_.end(), [&](const Awaited& other) { return other.due > due; });
  awaited_.insert(later, {look, due});
}

std::vector<VainLook> Looks::judge(const Surroundings& surroundings, time::Time now) {
  std::vector<VainLook> in_vain;
  const auto later =
      std::find_if(awaited_.begin(), awaited_.end(), [&](const Awaited& awaited) { return awaited.due > now; });
  for (auto due = awaited_.begin(); due != later; ++due) {
    if (has_frontier_at(surroundings, due->look.target_map)) in_vain.push_back(due->look);
  }
  awaited_.erase(awaited_.begin(), later);
  in_vain_.insert(in_vain_.end(), in_vain.begin(), in_vain.end());
  return in_vain;
}

void Looks::clear() {
  awaited_.clear();
  in_vain_.clear();
}

}  // namespace lapis::planner
