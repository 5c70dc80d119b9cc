#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/goal_memory.hpp"
#include "planner/core/exploration/mission_state.hpp"
#include "planner/core/exploration/progress_watch.hpp"
#include "planner/core/exploration/setbacks.hpp"
#include "planner/core/exploration/surroundings.hpp"
#include "planner/core/exploration/trail.hpp"

namespace lapis::planner {

struct ExplorerConfig {
  GoalMemoryConfig memory = {};
  PathConfig path = {};
  double replan_period_s = 1.0;  ///< between decisions while the robot drives to a goal; 0: no such decisions
  double goal_tolerance_m = 0.3;
  double goal_tolerance_rad = 0.3;
  double progress_timeout_s = 8.0;  ///< a goal has failed after this time without a motion of 0.3 m or 0.3 rad
  double slowest_m_s = 0.15;        ///< a path has failed when it takes longer than at this speed
  Allowance stall = {};             ///< a goal has failed when nothing new was seen for longer than this
  double settle_s = 1.5;            ///< from arrival until the map shows whether the view has failed
  double max_drift_m = 0.5;         ///< largest standard deviation of the position at a path's end in dead reckoning
  double lost_timeout_s = 60.0;     ///< exploration has failed after this time without a pose
  double path_spacing_m = 0.1;      ///< between the poses of the path
  int confirmations = 3;            ///< fruitless looks around before exploration ends; together they are a full turn
  double patience_s = 20.0;         ///< for obstacles that may go away, before exploration ends
  /// Largest Leftover::share_to_blame with which exploration is done; with more, it has given up.
  double max_left_share = 0.02;
  bool returns_home = false;  ///< when nothing is left to explore
  bool consolidates = false;  ///< when nothing is left to explore; consolidation does not end
};

enum class Tracking { kTracking, kDeadReckoning, kLost };

/// The state of the rest of the robot.
struct Report {
  time::Time now;
  std::optional<Pose2> robot;  ///< empty while slam has no pose
  Tracking tracking = Tracking::kLost;
  bool is_blocked = false;     ///< the controller finds no path; refers to the newest path only
  double drift_m = 0.0;        ///< standard deviation of the position since slam tracked last
  bool is_map_behind = false;  ///< the pose graph has been corrected, and the map does not yet contain the correction
};

/// The mission: decides when to decide, acts on decisions, and decides when exploration is over.
class Explorer {
 public:
  explicit Explorer(const ExplorerConfig& config);
  /// Replaces the configuration, except for memory and stall, which have to be the same.
  void reconfigure(const ExplorerConfig& config) { config_ = config; }

  void start();
  void stop();
  /// Returns false when there is nothing to pause.
  bool pause();
  void return_home();
  /// Drives to a place instead of exploring, and pauses there, or where no path leads on.
  void go_to(const Destination& place);
  /// slam has begun another map: forgets all places of the old map, including the place where the mission started.
  void forget_map();

  /// Evaluates what has happened since the last call. Returns true when a decision is wanted.
  /// @param surroundings null while there is no map
  bool step(const Report& report, Surroundings* surroundings);
  /// What decide() has to leave alone, and the current goal.
  Memory memory(time::Time now) const;
  /// Acts on a decision that was wanted. Returns false and changes nothing when the decision came too late, or when it
  /// was made before the path was found blocked: the decision did not know that the goal has failed.
  bool take(const Decision& decision, const Report& report);

  State state() const { return state_of(mission_); }
  /// Why the mission is in its state; while it consolidates, also how exploration ended.
  std::string reason() const;
  /// Path to the current goal; empty: stand still.
  const std::vector<Pose2>& path() const { return path_; }
  /// True when a decision chose the current goal.
  bool has_goal() const { return goal_ && goal_->target_map; }
  /// True when the path is not in the map frame: the robot turns on the spot, and the path holds headings relative to
  /// its current heading.
  bool is_turn() const { return is_turn_; }
  /// Number of goals so far that were not reached, or that were viewed in vain.
  std::uint64_t failures() const { return setbacks_.count(); }
  /// Increases with every new path.
  std::uint64_t path_number() const { return path_number_; }

 private:
  struct Goal {
    Pose2 pose = {};
    std::optional<Eigen::Vector2d> target_map = std::nullopt;  ///< empty: a look around, or the path home
    CandidateKind kind = CandidateKind::kFrontier;
    int turns_to = 0;            ///< as in Memory
    time::Time set_out_at = {};  ///< when the robot set out; not renewed by a detour
    std::optional<time::Time> deadline = std::nullopt;
    std::optional<Eigen::Vector2d> deadline_of_map = std::nullopt;  ///< the target for which the deadline was set
    Pose2 moved_from;                                               ///< pose at which a motion was noticed last
    time::Time moved_at;
  };

  void enter(MissionState mission, std::string reason);
  void fail(std::string reason) { enter(Ended{State::kFailed, ""}, std::move(reason)); }
  void resume(std::string reason);
  void set_path(std::vector<Pose2> path, bool is_turn = false);
  void drop_goal();
  void end_visit();
  void note_pose(const Report& report);
  void await_first_pose(time::Time now);
  void look_for_pose(time::Time now);
  bool explore(Exploring& exploring, const Report& report, Surroundings& surroundings);
  bool consolidate(const Consolidating& consolidating, const Report& report, Surroundings& surroundings);
  bool ends_goal(const Report& report, Surroundings& surroundings);
  bool is_stopped(const Report& report, Surroundings& surroundings);
  void act_on(Exploring& exploring, const Decision& decision, const Report& report);
  void act_on(Consolidating& consolidating, const Decision& decision, time::Time now);
  void follow(const Decision& decision, time::Time now);
  bool is_detour(const Decision& decision) const;
  void set_deadline(const Candidate& chosen, bool is_detour, time::Time now);
  void end_or_look_around(Exploring& exploring, const Decision& decision, const Report& report);
  void end(const Leftover& leftover);
  bool has_another_chance(Exploring& exploring, const Decision& decision, const Report& report);
  void recover(const Report& report);
  std::optional<Adrift> adrift(const Exploring& exploring) const;
  bool is_beyond_budget() const { return is_adrift_ && !(drift_m_ <= config_.max_drift_m); }
  bool is_of_other_tier(const Goal& goal) const;
  void note_loss(time::Time now);
  void return_or_go(Returning returning, const Report& report, Surroundings& surroundings);
  bool is_at_end(const Returning& returning, const Pose2& robot) const;
  void arrive(const Returning& returning);
  void drive_to(const Pose2& to, const Report& report, const Surroundings& surroundings);
  void note_arrival(time::Time now);
  void note_vanished(const Decision& decision, time::Time now);
  bool is_active() const;
  bool may_yet_return(const Report& report, Surroundings& surroundings);
  bool is_at(const Goal& goal, const Pose2& robot) const;
  bool stands_still(const Report& report);
  bool is_due(time::Time now, double period_s) const;
  void note_blocked(const Report& report, Surroundings& surroundings);
  void add_failure(time::Time now, bool is_adrift);

  ExplorerConfig config_;
  MissionState mission_;
  std::string reason_ = "not started";
  Setbacks setbacks_;
  ProgressWatch progress_;
  std::vector<Pose2> path_;
  bool is_turn_ = false;
  std::uint64_t path_number_ = 0;
  std::optional<Goal> goal_;
  std::vector<Eigen::Vector2d> awaited_;  ///< targets that wait for a correction of the map [m, map]
  std::optional<Pose2> home_;
  Pose2 robot_;  ///< last known pose
  Trail trail_;
  std::optional<time::Time> decided_at_;   ///< last decision or search for a path home in this state
  std::optional<time::Time> chosen_at_;    ///< when the last decision took effect
  std::optional<time::Time> blind_since_;  ///< while the mission is active: since when slam has had no pose
  bool is_adrift_ = false;                 ///< slam is in dead reckoning
  double drift_m_ = 0.0;                   ///< standard deviation of the position since slam tracked
  double reckoned_m_ = 0.0;                ///< distance driven since then
  bool may_change_ = false;                ///< obstacles stand where the map is free, and may go away
};

}  // namespace lapis::planner
