#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct GoalMemoryConfig {
  double radius_m = 0.75;  ///< targets that are nearer to each other count as one
  double expiry_s = 30.0;  ///< time for which a failed target is left alone
  int max_failures = 3;    ///< number of failures after which a target is left alone for good
};

/// How a target failed.
struct Failure {
  Rejection why = Rejection::kFailed;                      ///< kFailedView or kFailed
  std::optional<Eigen::Vector2d> from_map = std::nullopt;  ///< position from which the target was to be viewed [m, map]
  bool is_adrift = false;                                  ///< slam was in dead reckoning
};

/// Targets that the robot set out for and that failed: where, from which side, why, and under which circumstances. The
/// memory holds positions, not ids, because a frontier's id changes while the frontier moves forward. A failure is
/// forgotten when the map around the target has changed.
class GoalMemory {
 public:
  explicit GoalMemory(const GoalMemoryConfig& config) : config_(config) {}

  /// Leaves the target alone until the given time, whatever happens. This is not a failure.
  void leave_alone(const Eigen::Vector2d& target_map, time::Time until);
  void add_failure(const Eigen::Vector2d& target_map, const Failure& failure, time::Time now);
  /// Forgets the failures of targets around which at least `change` more cells are known than at the first call after
  /// the target's last failure, and returns these targets. They are still left alone until the time that was set
  /// before.
  std::vector<Eigen::Vector2d> forget_changed(const std::function<int(const Eigen::Vector2d& target_map)>& known_cells,
                                              int change);
  /// Targets to leave alone, for a time or for good, because views of them or paths to them have failed. Failures that
  /// all happened in dead reckoning count only while the robot is in dead reckoning.
  std::vector<LeftAlone> left_alone(time::Time now, bool is_adrift) const;
  /// Allows another try of all targets that have not failed for good, and one more try, from another side, of each that
  /// has. Returns false when there are no such targets.
  bool forgive(time::Time now);
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector2d target_map;
    int failures = 0;                          ///< here, and later ones within the radius
    Rejection worst = Rejection::kFailedView;  ///< worst reason of these failures
    Failure last = {};
    bool is_only_adrift = true;                     ///< all failures happened in dead reckoning
    std::optional<int> known_cells = std::nullopt;  ///< number of known cells around the target after its last failure
    bool has_last_chance = false;                   ///< it may be tried once more, from another side
    time::Time until{};                             ///< left alone until then after a failure
    time::Time awaited_until{};                     ///< left alone until then for another reason
  };
  Place& place_at(const Eigen::Vector2d& target_map);
  bool is_given_up(const Place& place) const { return place.failures >= config_.max_failures; }
  /// The target may be tried from another side, and has not failed since.
  bool is_at_last_chance(const Place& place) const {
    return place.has_last_chance && place.failures == config_.max_failures;
  }

  GoalMemoryConfig config_;
  std::vector<Place> places_;
};

}  // namespace lapis::planner
