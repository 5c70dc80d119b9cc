#include "planner/core/exploration/goal_memory.hpp"

#include <algorithm>

namespace lapis::planner {

void GoalMemory::add_failure(const Eigen::Vector2d& target_map, time::Time now) {
  const time::Time until = now + time::Duration::from_seconds(config_.expiry_s);
  for (Failure& failure : failures_) {
    if ((failure.target_map - target_map).norm() > config_.radius_m) continue;
    ++failure.count;
    failure.until = until;
    return;
  }
  failures_.push_back({target_map, 1, until});
}

std::vector<std::uint32_t> GoalMemory::given_up(const PlanningGrid& grid, const FrontierMap& frontiers,
                                                time::Time now) const {
  std::vector<std::uint32_t> ids;
  for (const auto& entry : frontiers.frontiers()) {
    const Frontier& frontier = entry.second;
    const auto is_near = [&](const Failure& failure) {
      if (!is_left_alone(failure, now)) return false;
      return std::any_of(frontier.representatives.begin(), frontier.representatives.end(), [&](Cell c) {
        return (grid.center_of(c) - failure.target_map).norm() <= config_.radius_m;
      });
    };
    if (std::any_of(failures_.begin(), failures_.end(), is_near)) ids.push_back(frontier.id);
  }
  return ids;
}

bool GoalMemory::forgive() {
  bool has_forgiven = false;
  for (Failure& failure : failures_) {
    if (failure.count >= config_.max_failures || failure.until == time::Time{}) continue;
    failure.until = {};
    has_forgiven = true;
  }
  return has_forgiven;
}

}  // namespace lapis::planner
