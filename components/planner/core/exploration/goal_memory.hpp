#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct GoalMemoryConfig {
  double radius_m = 0.75;  ///< what lies nearer to each other is one target
  double expiry_s = 30.0;  ///< time for which a target that failed is left alone
  int max_failures = 3;    ///< after so many it is left alone for good
};

/// How a target failed.
struct Failure {
  Rejection why = Rejection::kFailed;                      ///< kFailedView or kFailed
  std::optional<Eigen::Vector2d> from_map = std::nullopt;  ///< where it was to be looked at from [m, map]
  bool is_adrift = false;                                  ///< slam reckoned by odometry alone
};

/// Targets for which the robot set out, and failed: where, from which side, why, and under which circumstances.
/// Frontiers change their ids while they creep forward, so places are remembered. What has failed is forgotten when the
/// map around it has become another.
class GoalMemory {
 public:
  explicit GoalMemory(const GoalMemoryConfig& config) : config_(config) {}

  /// Not a failure: the target is left alone until then, however it ends.
  void leave_alone(const Eigen::Vector2d& target_map, time::Time until);
  void add_failure(const Eigen::Vector2d& target_map, const Failure& failure, time::Time now);
  /// Forgets how targets failed around which so many more cells are known than when this was called first after their
  /// last failure, and returns them; they are left alone for as long as they were to be.
  std::vector<Eigen::Vector2d> forget_changed(const std::function<int(const Eigen::Vector2d& target_map)>& known_cells,
                                              int change);
  /// Targets to leave alone: for now, or for good, because views of it, or paths to it, have failed. What failed only
  /// adrift counts only while the robot is.
  std::vector<LeftAlone> left_alone(time::Time now, bool is_adrift) const;
  /// Lets all targets be tried again that have not failed for good, and each of those that have once more, from another
  /// side; false when there are none.
  bool forgive(time::Time now);
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector2d target_map;
    int failures = 0;                          ///< here, and within the radius since
    Rejection worst = Rejection::kFailedView;  ///< of these
    Failure last = {};
    bool is_only_adrift = true;                     ///< all of them
    std::optional<int> known_cells = std::nullopt;  ///< around it, after that
    bool has_last_chance = false;                   ///< from another side than that of the last failure
    time::Time until{};                             ///< after a failure
    time::Time awaited_until{};                     ///< for another reason
  };
  Place& place_at(const Eigen::Vector2d& target_map);
  bool is_given_up(const Place& place) const { return place.failures >= config_.max_failures; }
  /// It may be tried from another side, and has not failed so.
  bool is_at_last_chance(const Place& place) const {
    return place.has_last_chance && place.failures == config_.max_failures;
  }

  GoalMemoryConfig config_;
  std::vector<Place> places_;
};

}  // namespace lapis::planner
