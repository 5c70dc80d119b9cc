#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct GoalMemoryConfig {
  double radius_m = 0.75;  ///< what lies nearer to each other is one target, in [0.1, 10]
  double expiry_s = 30.0;  ///< time for which a target that failed is left alone, in [0, 3600]
  int max_failures = 3;    ///< after so many it is left alone for good, in [1, 100]
};

/// Targets for which the robot set out, and failed. Frontiers change their ids while they creep forward, so places are
/// remembered.
class GoalMemory {
 public:
  explicit GoalMemory(const GoalMemoryConfig& config) : config_(config) {}

  /// Not a failure: the target is left alone until then, however it ends.
  void leave_alone(const Eigen::Vector2d& target_map, time::Time until);
  /// @param why kFailedView or kFailed
  void add_failure(const Eigen::Vector2d& target_map, Rejection why, time::Time now);
  /// Targets to leave alone: for now, or for good, because all views of it, or paths to it, have failed.
  std::vector<LeftAlone> left_alone(time::Time now) const;
  /// Lets all targets be tried again that have not failed for good; false when there are none.
  bool forgive(time::Time now);
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector2d target_map;
    int failures = 0;                          ///< here, and within the radius since
    Rejection worst = Rejection::kFailedView;  ///< of these
    time::Time until{};
  };
  Place& place_at(const Eigen::Vector2d& target_map);
  bool is_given_up(const Place& place) const { return place.failures >= config_.max_failures; }

  GoalMemoryConfig config_;
  std::vector<Place> places_;
};

}  // namespace lapis::planner
