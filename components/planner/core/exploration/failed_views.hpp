#pragma once

#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// Views of targets, judged when the map has had time to show: where a frontier is still there after a view of it, that
/// view has failed: the target is glass, or noise. But not where frames that show it wait for the map's correction.
class FailedViews {
 public:
  /// The target is judged at the first call of judge() from `due` on.
  void await(const FailedView& view, time::Time due);
  /// Those now due that have failed.
  /// `counts_awaited`: also of frontiers that wait for a correction of the map.
  std::vector<FailedView> judge(const Surroundings& surroundings, bool counts_awaited, time::Time now);
  /// All that have failed.
  const std::vector<FailedView>& all() const { return failed_; }
  void forgive() { failed_.clear(); }
  /// The map around a target has become another.
  void forget(const Eigen::Vector2d& target_map, double radius_m);
  void clear();

 private:
  struct Awaited {
    FailedView view;  ///< if it fails
    time::Time due;
  };
  std::vector<Awaited> awaited_;  ///< the first due first
  std::vector<FailedView> failed_;
};

}  // namespace lapis::planner
