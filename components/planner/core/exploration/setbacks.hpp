#pragma once

#include <cstdint>
#include <vector>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/failed_views.hpp"
#include "planner/core/exploration/goal_memory.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// What has failed on the mission: targets that were not reached or were viewed in vain, places that stopped the robot,
/// and targets on the way to which slam lost track. Decisions leave all of them alone.
class Setbacks {
 public:
  explicit Setbacks(const GoalMemoryConfig& config);

  /// Another mission begins on the same map: everything may be tried again.
  void begin_anew();
  /// slam has begun another map: forgets all places.
  void forget_map();

  /// The robot has arrived. The target is left alone for `seconds`; then the map shows whether the view has failed.
  void await(const FailedView& view, time::Time now, double seconds);
  /// Judges the views that are due, and forgets failures where the map has changed since.
  /// @param counts_awaited frontiers that wait for a correction of the map count, too
  void judge(const Surroundings& surroundings, bool counts_awaited, bool is_adrift, time::Time now);
  /// The robot took a view of gaps.
  void note_view(const Pose2& taken) { taken_views_.push_back(taken); }
  /// The robot revisited an old place, which counts as a failure there, so that it does not revisit the place for ever.
  void note_revisit(const Eigen::Vector2d& target_map, bool is_adrift, time::Time now);
  /// The robot did not reach the goal. For revisits and for views of gaps, the place failed, which says nothing about a
  /// frontier beside it.
  void note_failure(CandidateKind kind, const Eigen::Vector2d& target_map, const Pose2& goal, bool is_adrift,
                    time::Time now);
  /// slam stopped tracking on the way to a target. Returns true when this has happened before at the target: then the
  /// cause is what is seen there.
  bool note_loss(const Eigen::Vector2d& target_map);
  /// Something on the path stopped the robot at this place.
  void block(const Eigen::Vector2d& place_map, time::Time now) { blocked_.add_failure(place_map, {}, now); }

  /// Allows another try of targets that are left alone for a time, and one more try from another side of those that
  /// failed for good.
  bool forgive_targets(time::Time now) { return targets_.forgive(now); }
  /// Allows paths through places that were blocked. Returns false when there are none.
  bool forgive_blocked(time::Time now) { return blocked_.forgive(now); }

  std::vector<Eigen::Vector2d> blocked_places(bool is_adrift, time::Time now) const;
  /// What decisions have to leave alone.
  Memory memory(bool is_adrift, time::Time now) const;
  /// Number of goals so far that were not reached, or that were viewed in vain.
  std::uint64_t count() const { return count_; }

 private:
  GoalMemoryConfig config_;
  GoalMemory targets_;     ///< of frontiers
  GoalMemory old_places_;  ///< old key-frames
  GoalMemory gap_places_;  ///< places of views of gaps
  GoalMemory blocked_;     ///< places on the path that stopped the robot
  FailedViews failed_views_;
  std::vector<Pose2> taken_views_;       ///< views of gaps
  std::vector<Eigen::Vector2d> losses_;  ///< targets on the way to which slam stopped tracking [m, map]
  std::uint64_t count_ = 0;
};

}  // namespace lapis::planner
