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
  double replan_period_s = 1.0;  ///< between decisions while a goal is being driven to; 0: none
  double goal_tolerance_m = 0.3;
  double goal_tolerance_rad = 0.3;
  double progress_timeout_s = 8.0;  ///< without moving 0.3 m or 0.3 rad, a goal has failed
  double slowest_m_s = 0.15;        ///< a path that takes longer than at this speed has failed
  Allowance stall = {};             ///< without seeing anything new before a goal has failed
  double settle_s = 1.5;            ///< after arriving, until the map shows whether the view has failed
  double max_drift_m = 0.5;         ///< sigma of the position by odometry alone at a path's end
  double lost_timeout_s = 60.0;     ///< without a pose, exploration has failed
  double path_spacing_m = 0.1;      ///< between poses of the path
  int confirmations = 3;            ///< looks around, a full turn in all, that find nothing before it is over
  double patience_s = 20.0;         ///< for obstacles that may go away before it is over
  double max_left_share = 0.02;     ///< Leftover::share_to_blame with which it is over all the same
  bool returns_home = false;        ///< when nothing is left
  bool consolidates = false;        ///< when nothing is left, for ever
};

enum class Tracking { kTracking, kDeadReckoning, kLost };

/// What the rest of the robot says.
struct Report {
  time::Time now;
  std::optional<Pose2> robot;  ///< nothing while slam has no pose
  Tracking tracking = Tracking::kLost;
  bool is_blocked = false;     ///< the controller finds no path; only true when it speaks of the newest path
  double drift_m = 0.0;        ///< sigma of the position since slam tracked last
  bool is_map_behind = false;  ///< the graph has been corrected, and the map is not yet
};

/// The mission: when to decide, what to do with the decision, and when it is over.
class Explorer {
 public:
  explicit Explorer(const ExplorerConfig& config);

  void start();
  void stop();
  /// False when there is nothing to pause.
  bool pause();
  void return_home();
  /// Places are of a map that is gone: none is known any more, not even where it started.
  void forget_map();

  /// Looks at what has happened since the last call. True when a decision is wanted.
  bool step(const Report& report, Surroundings* surroundings);
  /// What decide() has to leave alone, and what is being driven to.
  Memory memory(time::Time now) const;
  /// Acts on a decision that was wanted. One that came too late changes nothing, nor does one that was made before the
  /// path was found blocked: the goal that it did not know to have failed is judged first. False for these.
  bool take(const Decision& decision, const Report& report);

  State state() const { return state_of(mission_); }
  /// While it consolidates, also how exploration ended.
  std::string reason() const;
  /// To the current goal; empty: stand still.
  const std::vector<Pose2>& path() const { return path_; }
  /// Somebody has chosen where it drives to.
  bool has_goal() const { return goal_ && goal_->target_map; }
  /// The path is not of the map: it turns on the spot, through headings relative to the one that the robot has now.
  bool is_turn() const { return is_turn_; }
  /// Goals so far that were not reached, or looked at in vain.
  std::uint64_t failures() const { return setbacks_.count(); }
  /// Grows with every new path.
  std::uint64_t path_number() const { return path_number_; }

 private:
  struct Goal {
    Pose2 pose = {};
    std::optional<Eigen::Vector2d> target_map = std::nullopt;  ///< none: a look around, or the path home
    CandidateKind kind = CandidateKind::kFrontier;
    int turns_to = 0;            ///< as in Memory
    time::Time set_out_at = {};  ///< from where none was left for another
    std::optional<time::Time> deadline = std::nullopt;
    std::optional<Eigen::Vector2d> deadline_of_map = std::nullopt;  ///< the target at which it was set
    Pose2 moved_from;                                               ///< where the robot was when it last had moved
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
  void go_home(const Returning& returning, const Report& report, Surroundings& surroundings);
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
  Pose2 robot_;  ///< where it was known to be last
  Trail trail_;
  std::optional<time::Time> decided_at_;   ///< in this state
  std::optional<time::Time> chosen_at_;    ///< the last decision took effect
  std::optional<time::Time> blind_since_;  ///< while it was active: slam has no pose
  bool is_adrift_ = false;                 ///< slam reckons by odometry alone
  double drift_m_ = 0.0;                   ///< sigma of the position since slam tracked
  double reckoned_m_ = 0.0;                ///< driven since
  bool may_change_ = false;                ///< obstacles stand where there may soon be none
};

}  // namespace lapis::planner
