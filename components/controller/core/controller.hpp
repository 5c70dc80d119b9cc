#pragma once

#include <algorithm>
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
  double look_ahead_m = 1.0;   ///< distance of the goal ahead on the planner's path
  double slow_within_m = 0.4;  ///< the robot slows down nearer to obstacles than this
  double slowest_share = 0.4;  ///< share of the full speed beside an obstacle
  double goal_tolerance_m = 0.15;
  double heading_tolerance_rad = 0.1;
  double patience_s = 1.0;  ///< time without a free path before the robot tries to recover
  double back_up_m = 0.3;
  double back_up_speed_m_s = 0.15;
  double recovery_turn_rad = 1.6;
  double progress_timeout_s = 6.0;
  double look_around_rad_s = 0.3;  ///< rate of a turn on the spot; slow, because images blur
  double weak_turn_rad_s = 0.55;   ///< largest rate of any turn while views are weak
  /// What the robot is asked for at most, if its own limits are not lower.
  double speed_limit_m_s = 5.0, turn_limit_rad_s = 10.0;
};

/// Points in base_link.
using Obstacles = std::vector<Eigen::Vector2d>;

/// What the robot does.
enum class State { kIdle, kFollowing, kBlocked, kStopped };

/// The current command and its reason.
struct Decision {
  State state = State::kIdle;
  std::string reason;
  Velocity command;
  double distance_to_goal_m = 0.0;     ///< along the path
  std::vector<PlanarPose> local_path;  ///< the path that is being driven, in the map frame
};

/// Follows a path among obstacles, and stops when a required input is too old. `now` comes from the same clock in all
/// calls.
class Controller {
 public:
  /// Throws std::runtime_error naming the value that is out of range.
  Controller(const ControllerConfig& config, const RobotLimits& limits);

  /// Replaces the configuration, except for fan, local map and watchdog, which have to be the same.
  void reconfigure(const ControllerConfig& config) { config_ = config; }

  /// Sets the path, in the map frame. An empty path makes the robot stand still, for the given reason. With the same
  /// path as before, it continues where it is; if it was blocked, it tries again.
  void set_path(std::vector<PlanarPose> path, const std::string& reason_if_empty);
  /// Replaces the path by a turn on the spot from the current heading [rad, positive to the left], which may exceed a
  /// full turn. It needs no pose, no map and no free space: the angle turned so far is integrated from the commands.
  /// With the same turn as before, the turn continues.
  void set_turn(double turn_rad);
  void note_planner(time::Time now) { watchdog_.note(Input::kPlanner, now); }
  void note_camera(time::Time stamp, time::Time now) { watchdog_.note(Input::kCamera, now, stamp); }
  void set_pose(const PlanarPose& T_map_base, time::Time stamp, time::Time now);
  /// Weak: features do not determine the pose now. The robot then turns slowly, which keeps surfaces in view for longer
  /// and blurs images less.
  void set_weak_views(bool are_weak) { are_views_weak_ = are_weak; }
  /// Adds the depth image that was taken at the pose set last.
  void see(const DepthView& view, time::Time stamp, time::Time now);
  void set_plan(Grid grid) { map_.set_plan(std::move(grid)); }
  void set_obstacles(Grid grid, time::Time stamp, time::Time now);

  /// The current command; to be called 10 to 20 times per second.
  Decision step(time::Time now);

 private:
  /// The phases of recovery without a free path: wait, back up, look around; then the planner has to act.
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
  double most_speed() const { return std::min(limits_.max_speed_m_s, config_.speed_limit_m_s); }
  double speed_limit(const LocalPath& local_path, const Obstacles& obstacles) const;
  bool may_back_up(const Obstacles& obstacles) const;
  bool is_stuck(time::Time now);
  bool has_tried() const;
  double turn_limit() const;
  double turn_rate(double error_rad) const;
  /// Point on the path this far ahead, in base_link.
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
  std::optional<double> turn_rad_;  // a turn on the spot that replaces the path
  double turned_rad_ = 0.0;         // angle turned so far, integrated from commands
  double blindly_rad_ = 0.0;        // angle turned in this way since the last pose
  std::string idle_reason_ = "no path yet";
  bool is_arrived_ = false;  // at the path's end, except for the heading
  std::optional<time::Time> last_step_;
  Velocity last_;                        // command
  std::optional<LocalPath> local_path_;  // of the last step

  Recovery recovery_ = Recovery::kNone;
  time::Time phase_began_;
  PlanarPose T_map_phase_ = PlanarPose::Identity();  // where the phase began
  bool turns_left_ = true;                           // in the phase kTurning
  std::optional<time::Time> moved_at_;               // when the robot last made progress,
  Eigen::Vector2d moved_to_{0.0, 0.0};               // and its position at that time
  std::optional<Eigen::Vector2d> tried_at_;          // where recovery has failed
};

}  // namespace lapis::controller
