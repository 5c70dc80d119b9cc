#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "planner/core/space/frontier_map.hpp"

namespace lapis::planner {

struct GoalMemoryConfig {
  double radius_m = 0.75;   ///< what lies nearer to each other is one target, in [0.1, 10]
  double expiry_s = 30.0;   ///< time for which a target that failed is left alone, in [0, 3600]
  int max_failures = 3;     ///< after so many it is left alone for good, in [1, 100]
};

/// Targets that were driven to in vain. Frontiers change their ids while they creep forward, so places are remembered.
class GoalMemory {
 public:
  explicit GoalMemory(const GoalMemoryConfig& config) : config_(config) {}

  void add_failure(const Eigen::Vector2d& target_map, time::Time now);
  /// Frontiers to leave alone for now, by ascending id: those with a representative at such a target.
  std::vector<std::uint32_t> given_up(const PlanningGrid& grid, const FrontierMap& frontiers, time::Time now) const;
  /// Lets all targets be tried again that have not failed for good; false when there are none.
  bool forgive();
  void clear() { failures_.clear(); }

 private:
  struct Failure {
    Eigen::Vector2d target_map;
    int count;
    time::Time until;
  };
  bool is_left_alone(const Failure& failure, time::Time now) const {
    return failure.count >= config_.max_failures || now < failure.until;
  }

  GoalMemoryConfig config_;
  std::vector<Failure> failures_;
};

}  // namespace lapis::planner
