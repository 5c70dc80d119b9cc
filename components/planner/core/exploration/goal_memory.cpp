#include "planner/core/exploration/goal_memory.hpp"

#include <algorithm>

namespace lapis::planner {

GoalMemory::Place& GoalMemory::place_at(const Eigen::Vector2d& target_map) {
  const auto found =
      std::find_if(places_.begin(), places_.end(), [&](const Place& place) { return place.target_map == target_map; });
  return found != places_.end() ? *found : places_.emplace_back(Place{.target_map = target_map});
}

void GoalMemory::leave_alone(const Eigen::Vector2d& target_map, time::Time until) {
  Place& place = place_at(target_map);
  place.until = std::max(place.until, until);
}

void GoalMemory::add_failure(const Eigen::Vector2d& target_map, Rejection why, time::Time now) {
  leave_alone(target_map, now + time::Duration::from_seconds(config_.expiry_s));
  for (Place& place : places_) {
    if ((place.target_map - target_map).norm() > config_.radius_m) continue;
    ++place.failures;
    place.worst = std::max(place.worst, why);
  }
}

std::vector<LeftAlone> GoalMemory::left_alone(time::Time now) const {
  std::vector<LeftAlone> targets;
  for (const Place& place : places_) {
    if (is_given_up(place)) {
      targets.push_back({place.target_map, place.worst});
    } else if (now < place.until) {
      targets.push_back({place.target_map});
    }
  }
  return targets;
}

bool GoalMemory::forgive(time::Time now) {
  bool has_forgiven = false;
  for (Place& place : places_) {
    if (is_given_up(place) || place.until <= now) continue;
    place.until = now;
    has_forgiven = true;
  }
  return has_forgiven;
}

}  // namespace lapis::planner
