#pragma once

#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// Views of targets, judged when the map has had time to show their effect. A view has failed when a frontier is still
/// at its target: the target is glass, or noise. Frontiers that are seen by frames that wait for the map's correction
/// do not count.
class FailedViews {
 public:
  /// The view is judged at the first call of judge() at or after `due`.
  void await(const FailedView& view, time::Time due);
  /// Judges the views that are due, and returns those that have failed.
  /// @param counts_awaited frontiers that wait for a correction of the map count, too
  std::vector<FailedView> judge(const Surroundings& surroundings, bool counts_awaited, time::Time now);
  /// All views that have failed.
  const std::vector<FailedView>& all() const { return failed_; }
  void forgive() { failed_.clear(); }
  /// Forgets the failed views of a target because the map around it has changed.
  void forget(const Eigen::Vector2d& target_map, double radius_m);
  void clear();

 private:
  struct Awaited {
    FailedView view;  ///< returned if it fails
    time::Time due;
  };
  std::vector<Awaited> awaited_;  ///< sorted by `due`
  std::vector<FailedView> failed_;
};

}  // namespace lapis::planner
