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
  place.awaited_until = std::max(place.awaited_until, until);
}

void GoalMemory::add_failure(const Eigen::Vector2d& target_map, const Failure& failure, time::Time now) {
  Place& here = place_at(target_map);
  here.until = std::max(here.until, now + time::Duration::from_seconds(config_.expiry_s));
  for (Place& place : places_) {
    if ((place.target_map - target_map).norm() > config_.radius_m) continue;
    ++place.failures;
    place.worst = std::max(place.worst, failure.why);
    place.last = failure;
    place.is_only_adrift = place.is_only_adrift && failure.is_adrift;
    place.known_cells.reset();
  }
}

std::vector<Eigen::Vector2d> GoalMemory::forget_changed(const std::function<int(const Eigen::Vector2d&)>& known_cells,
                                                        int change) {
  std::vector<Eigen::Vector2d> forgotten;
  for (Place& place : places_) {
    if (place.failures == 0) continue;
    const int now = known_cells(place.target_map);
    if (!place.known_cells) place.known_cells = now;
    if (now < *place.known_cells + change) continue;
    forgotten.push_back(place.target_map);
    place = {.target_map = place.target_map, .until = place.until, .awaited_until = place.awaited_until};
  }
  return forgotten;
}

std::vector<LeftAlone> GoalMemory::left_alone(time::Time now, bool is_adrift) const {
  std::vector<LeftAlone> targets;
  for (const Place& place : places_) {
    const bool may_succeed = place.failures > 0 && place.is_only_adrift && !is_adrift;
    if (now < place.awaited_until) {
      targets.push_back({place.target_map});
    } else if (may_succeed) {
      continue;
    } else if (is_given_up(place) && !is_at_last_chance(place)) {
      targets.push_back({place.target_map, place.worst});
    } else if (now < place.until) {
      targets.push_back({place.target_map});
    } else if (is_given_up(place)) {
      targets.push_back({place.target_map, place.worst, place.last.from_map});
    }
  }
  return targets;
}

bool GoalMemory::forgive(time::Time now) {
  bool has_forgiven = false;
  for (Place& place : places_) {
    const bool may_have_another = place.last.from_map && !place.has_last_chance;
    if (is_given_up(place) ? !may_have_another : std::max(place.until, place.awaited_until) <= now) continue;
    place.has_last_chance = is_given_up(place);
    place.until = place.awaited_until = now;
    has_forgiven = true;
  }
  return has_forgiven;
}

}  // namespace lapis::planner
