#include "planner/core/exploration/setbacks.hpp"

#include <algorithm>
#include <limits>

namespace lapis::planner {
namespace {

constexpr double kBlockedRadius_m = 0.2;  // obstructions that are nearer to each other count as one
constexpr int kChange_cells = 5;          // new known cells around a failed target that may make it succeed

// A person in the way may leave, however often that happens, so blocked places are never given up.
GoalMemoryConfig memory_of_blocked(GoalMemoryConfig config) {
  config.radius_m = kBlockedRadius_m;
  config.max_failures = std::numeric_limits<int>::max();
  return config;
}

}  // namespace

Setbacks::Setbacks(const GoalMemoryConfig& config)
    : config_(config), targets_(config), old_places_(config), gap_places_(config), blocked_(memory_of_blocked(config)) {
}

void Setbacks::begin_anew() {
  targets_.clear();
  old_places_.clear();
  gap_places_.clear();
  blocked_.clear();
  failed_views_.forgive();
  taken_views_.clear();
  losses_.clear();
}

void Setbacks::forget_map() {
  begin_anew();
  failed_views_.clear();
}

void Setbacks::await(const FailedView& view, time::Time now, double seconds) {
  const time::Time due = now + time::Duration::from_seconds(seconds);
  failed_views_.await(view, due);
  targets_.leave_alone(view.target_map, due);
}

void Setbacks::judge(const Surroundings& surroundings, bool counts_awaited, bool is_adrift, time::Time now) {
  const auto known_cells = [&](const Eigen::Vector2d& target_map) {
    return surroundings.known_cells(target_map, config_.radius_m);
  };
  for (const Eigen::Vector2d& target_map : targets_.forget_changed(known_cells, kChange_cells))
    failed_views_.forget(target_map, config_.radius_m);
  for (const FailedView& view : failed_views_.judge(surroundings, counts_awaited, now)) {
    targets_.add_failure(view.target_map, {Rejection::kFailedView, view.from_map, is_adrift}, now);
    ++count_;
  }
}

void Setbacks::note_revisit(const Eigen::Vector2d& target_map, bool is_adrift, time::Time now) {
  old_places_.add_failure(target_map, {.is_adrift = is_adrift}, now);
}

void Setbacks::note_failure(CandidateKind kind, const Eigen::Vector2d& target_map, const Pose2& goal, bool is_adrift,
                            time::Time now) {
  ++count_;
  if (kind == CandidateKind::kTracked) return;
  const Failure failure{Rejection::kFailed, goal.p_map, is_adrift};
  if (is_of_frontier(kind)) return targets_.add_failure(target_map, failure, now);
  (kind == CandidateKind::kGap ? gap_places_ : old_places_).add_failure(goal.p_map, failure, now);
}

bool Setbacks::note_loss(const Eigen::Vector2d& target_map) {
  const bool is_again = std::any_of(losses_.begin(), losses_.end(), [&](const Eigen::Vector2d& lost_map) {
    return (lost_map - target_map).norm() <= config_.radius_m;
  });
  losses_.push_back(target_map);
  return is_again;
}

std::vector<Eigen::Vector2d> Setbacks::blocked_places(bool is_adrift, time::Time now) const {
  std::vector<Eigen::Vector2d> places_map;
  for (const LeftAlone& place : blocked_.left_alone(now, is_adrift)) places_map.push_back(place.target_map);
  return places_map;
}

Memory Setbacks::memory(bool is_adrift, time::Time now) const {
  Memory memory;
  memory.left_alone = targets_.left_alone(now, is_adrift);
  memory.old_places = old_places_.left_alone(now, is_adrift);
  memory.gap_places = gap_places_.left_alone(now, is_adrift);
  memory.failed_views = failed_views_.all();
  memory.taken_views = taken_views_;
  memory.radius_m = config_.radius_m;
  return memory;
}

}  // namespace lapis::planner
