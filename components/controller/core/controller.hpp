#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/core/local_map.hpp"
#include "controller/core/local_planner.hpp"
#include "controller/core/motion.hpp"
#include "controller/core/path_track.hpp"
#include "controller/core/watchdog.hpp"

namespace lapis::controller {

struct ControllerConfig {
  FanConfig fan;
  LocalMapConfig local_map;
  WatchdogConfig watchdog;
  double look_ahead_m = 1.0;   ///< on the planner's path
  double slow_within_m = 0.4;  ///< nearer to obstacles than this the robot slows down
  double slowest_share = 0.4;  ///< of the full speed, beside an obstacle
  double goal_tolerance_m = 0.15;
  double heading_tolerance_rad = 0.1;
  double patience_s = 1.0;  ///< without a free path before the robot tries to recover
  double back_up_m = 0.3;
  double back_up_speed_m_s = 0.15;
  double recovery_turn_rad = 1.6;
  double progress_timeout_s = 6.0;
  double look_around_rad_s = 0.3;  ///< rate of a turn on the spot: slow, or images blur
  double weak_turn_rad_s = 0.55;   ///< any turn's, at most, while views are weak
};

/// Points in base_link.
using Obstacles = std::vector<Eigen::Vector2d>;

/// What the robot does about its path.
enum class State { kIdle, kFollowing, kBlocked, kStopped };

/// What to do now, and why.
struct Decision {
  State state = State::kIdle;
  std::string reason;
  Velocity command;
  double distance_to_goal_m = 0.0;     ///< along the path
  std::vector<PlanarPose> local_path;  ///< that is being driven, in the map frame
};

/// Follows a path among obstacles, and stops when what it needs to know is old. `now` is of one clock for all calls.
class Controller {
 public:
  /// Throws std::runtime_error naming the value that is out of range.
  Controller(const ControllerConfig& config, const RobotLimits& limits);

  /// In the map frame. Empty: the robot stands still, for that reason. The same path again: it continues where it is;
  /// when it was blocked, it tries again.
  void set_path(std::vector<PlanarPose> path, const std::string& reason_if_empty);
  /// In place of a path: on the spot, from where the robot stands now, to the left; more than a full turn is one, too.
  /// It needs no pose, no map and no room: how far the robot has turned is told by its own commands. The same turn
  /// again is continued.
  void set_turn(double turn_rad);
  void note_planner(time::Time now) { watchdog_.note(Input::kPlanner, now); }
  void note_camera(time::Time stamp, time::Time now) { watchdog_.note(Input::kCamera, now, stamp); }
  void set_pose(const PlanarPose& T_map_base, time::Time stamp, time::Time now);
  /// Features do not hold the pose now: turning slowly keeps what does in view for longer, and blurs less.
  void set_weak_views(bool are_weak) { are_views_weak_ = are_weak; }
  /// What the camera saw at the pose that was set last.
  void see(const DepthView& view, time::Time stamp, time::Time now);
  void set_plan(Grid grid) { map_.set_plan(std::move(grid)); }
  void set_obstacles(Grid grid, time::Time stamp, time::Time now);

  /// The command for now; to be asked 10 to 20 times a second.
  Decision step(time::Time now);

 private:
  /// What is tried when there is no free path: wait, back up, look around; then it is the planner's turn.
  enum class Recovery { kNone, kWaiting, kBackingUp, kTurning, kNoPath, kStuck };

  Decision decide(time::Time now, double elapsed_s);
  Decision stop_for(Input stale) const;
  Decision turn(time::Time now, double elapsed_s);
  Decision follow(time::Time now, double elapsed_s);
  Decision turn_first(double error_rad, double elapsed_s);
  Decision align(double elapsed_s);
  Decision drive(const Obstacles& obstacles, double elapsed_s) const;
  Decision recover(double elapsed_s) const;
  Velocity recovery_velocity() const;
  Recovery next_phase(const Obstacles& obstacles, time::Time now);
  void enter(Recovery phase, time::Time now);
  std::optional<LocalPath> find_local_path(const Surroundings& around) const;
  double speed_limit(const LocalPath& local_path, const Obstacles& obstacles) const;
  bool may_back_up(const Obstacles& obstacles) const;
  bool is_stuck(time::Time now);
  bool has_tried() const;
  double turn_limit() const;
  double turn_rate(double error_rad) const;
  /// In base_link.
  Eigen::Vector2d goal_ahead(double distance_m) const { return T_map_base_.inverse() * track_->ahead(distance_m); }

  ControllerConfig config_;
  RobotLimits limits_;
  Watchdog watchdog_;
  LocalMap map_;
  LocalPlanner planner_;
  PlanarPose T_map_base_ = PlanarPose::Identity();
  std::optional<time::Time> pose_stamp_;
  bool are_views_weak_ = false;

  std::optional<PathTrack> track_;
  std::optional<double> turn_rad_;  // on the spot, instead of a path
  double turned_rad_ = 0.0;         // of it, by commands
  double blindly_rad_ = 0.0;        // turned so since the pose that was set last
  std::string idle_reason_ = "no path yet";
  bool is_arrived_ = false;  // at the path's end, but for its heading
  std::optional<time::Time> last_step_;
  Velocity last_;                        // command
  std::optional<LocalPath> local_path_;  // of the last step

  Recovery recovery_ = Recovery::kNone;
  time::Time phase_began_;
  PlanarPose T_map_phase_ = PlanarPose::Identity();  // where the phase began
  bool turns_left_ = true;                           // in the phase of turning
  std::optional<time::Time> moved_at_;               // when the robot was last somewhere else,
  Eigen::Vector2d moved_to_{0.0, 0.0};               // and where it came to
  std::optional<Eigen::Vector2d> tried_at_;          // where recovery was of no use
};

}  // namespace lapis::controller
