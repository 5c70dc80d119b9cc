#pragma once

#include <cstdint>
#include <vector>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/failed_views.hpp"
#include "planner/core/exploration/goal_memory.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// What has failed on the mission: targets that were not reached or looked at in vain, places that stopped the robot,
/// and where slam lost itself. Decisions leave it alone.
class Setbacks {
 public:
  explicit Setbacks(const GoalMemoryConfig& config);

  /// Another mission on the same map: all may be tried again.
  void begin_anew();
  /// Places are of a map that is gone.
  void forget_map();

  /// The robot has arrived: the target is left alone until the map has had so long to show whether the view has failed.
  void await(const FailedView& view, time::Time now, double seconds);
  /// Views that are due are judged; what failed where the map has changed since is forgotten.
  /// @param counts_awaited also frontiers that wait for a correction of the map
  void judge(const Surroundings& surroundings, bool counts_awaited, bool is_adrift, time::Time now);
  /// A view of gaps was taken.
  void note_view(const Pose2& taken) { taken_views_.push_back(taken); }
  /// An old place was revisited: not for ever.
  void note_revisit(const Eigen::Vector2d& target_map, bool is_adrift, time::Time now);
  /// The goal was not reached. A place that cannot be had, of an old key-frame or for a view of gaps, says nothing of a
  /// frontier beside it.
  void note_failure(CandidateKind kind, const Eigen::Vector2d& target_map, const Pose2& goal, bool is_adrift,
                    time::Time now);
  /// Slam stopped tracking on the way to a target. True when it has done so before: it does so for what is seen there.
  bool note_loss(const Eigen::Vector2d& target_map);
  /// Something on the path stopped the robot here.
  void block(const Eigen::Vector2d& place_map, time::Time now) { blocked_.add_failure(place_map, {}, now); }

  /// Targets that are left alone for a time may be tried again, what has failed for good once more from another side.
  bool forgive_targets(time::Time now) { return targets_.forgive(now); }
  /// Where paths were blocked they may be free.
  bool forgive_blocked(time::Time now) { return blocked_.forgive(now); }

  std::vector<Eigen::Vector2d> blocked_places(bool is_adrift, time::Time now) const;
  /// What decisions have to leave alone.
  Memory memory(bool is_adrift, time::Time now) const;
  /// Goals so far that were not reached, or looked at in vain.
  std::uint64_t count() const { return count_; }

 private:
  GoalMemoryConfig config_;
  GoalMemory targets_;     ///< of frontiers
  GoalMemory old_places_;  ///< of key-frames
  GoalMemory gap_places_;  ///< for views of gaps
  GoalMemory blocked_;     ///< places on the path
  FailedViews failed_views_;
  std::vector<Pose2> taken_views_;       ///< of gaps
  std::vector<Eigen::Vector2d> losses_;  ///< targets on the way to which slam stopped tracking [m, map]
  std::uint64_t count_ = 0;
};

}  // namespace lapis::planner
