#include "controller/core/controller.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace lapis::controller {
namespace {

constexpr double kLongestStep_s = 0.2;   // longest time step for limits of acceleration
constexpr double kTrackWindow_m = 1.0;   // length of path ahead that is searched for the robot's position
constexpr double kTurnGain = 1.5;        // [1/s]
constexpr double kSlowTurn_rad_s = 0.2;  // slowest turn rate that the drives execute smoothly
constexpr double kTurnShare = 0.9;       // share of the largest turn rate that is used on arcs
constexpr double kAside_rad = 0.2;       // a blocked robot turns to the goal when its heading is off by more
constexpr double kCreep_m_s = 0.08;
// A pose is a jump when it is farther from the last one than the robot can have driven, by more than this.
constexpr double kJump_m = 0.15;
constexpr double kJump_rad = 0.15;
constexpr double kLongestBlind_s = 1.0;   // without a pose, the robot is assumed to move for at most this long
constexpr double kMoved_m = 0.3;          // less motion is no progress
constexpr double kRearRoom_m = 0.15;      // length behind the robot that must be free to back up
constexpr double kPhasePatience_s = 5.0;  // longest duration of turning or backing up, should the robot not move

/// Distance to the nearest point that is not behind the robot [m]; infinity without any.
double nearest_ahead(const Obstacles& obstacles) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : obstacles) {
    if (p.x() > 0.0) nearest = std::min(nearest, p.norm());
  }
  return nearest;
}

bool is_same(const std::vector<PlanarPose>& a, const std::vector<PlanarPose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const PlanarPose& x, const PlanarPose& y) { return x.matrix() == y.matrix(); });
}

}  // namespace

Controller::Controller(const ControllerConfig& config, const RobotLimits& limits)
    : config_(config), limits_(limits), watchdog_(config.watchdog), map_(config.local_map),
      planner_(PathFan(config.fan, limits.radius_m)) {}

void Controller::set_path(std::vector<PlanarPose> path, const std::string& reason_if_empty) {
  if (recovery_ == Recovery::kStuck) recovery_ = Recovery::kNone;
  turn_rad_.reset();
  if (track_ && is_same(track_->poses(), path)) return;
  track_.reset();
  is_arrived_ = false;
  if (path.empty()) {
    idle_reason_ = reason_if_empty;
  } else {
    track_.emplace(std::move(path));
  }
}

void Controller::set_turn(double turn_rad) {
  if (turn_rad_ == turn_rad) return;
  set_path({}, "the turn is done");
  turn_rad_ = turn_rad;
  turned_rad_ = 0.0;
}

void Controller::set_pose(const PlanarPose& T_map_base, time::Time stamp, time::Time now) {
  watchdog_.note(Input::kPose, now, stamp);
  if (pose_stamp_) {
    const PlanarPose T_map_last = T_map_base_ * planar_pose({0.0, 0.0}, blindly_rad_);
    const PlanarPose T_last_base = T_map_last.inverse() * T_map_base;
    const double elapsed_s = std::min(abs(stamp - *pose_stamp_).seconds(), kLongestBlind_s);
    const bool is_jump = T_last_base.translation().norm() > limits_.max_speed_m_s * elapsed_s + kJump_m ||
                         std::abs(yaw_of(T_last_base)) > limits_.max_turn_rate_rad_s * elapsed_s + kJump_rad;
    if (is_jump) map_.move_points(T_map_base * T_map_last.inverse());
  }
  blindly_rad_ = 0.0;
  pose_stamp_ = stamp;
  T_map_base_ = T_map_base;
}

void Controller::see(const DepthView& view, time::Time stamp, time::Time now) {
  watchdog_.note(Input::kView, now, stamp);
  map_.add(view, T_map_base_, stamp, track_ || turn_rad_ || is_steered(now));
}

void Controller::set_obstacles(Grid grid, time::Time stamp, time::Time now) {
  watchdog_.note(Input::kMap, now, stamp);
  map_.set_obstacles(std::move(grid));
}

Decision Controller::step(time::Time now) {
  const double elapsed_s = last_step_ ? std::clamp((now - *last_step_).seconds(), 0.0, kLongestStep_s) : 0.0;
  Decision decision = decide(now, elapsed_s);
  last_step_ = now;
  last_ = decision.command;
  if (track_) decision.distance_to_goal_m = track_->left_m();
  return decision;
}

Decision Controller::decide(time::Time now, double elapsed_s) {
  const auto stale = watchdog_.stale(now);
  const bool obeys_operator = is_steered(now);
  if (track_ && !stale && !obeys_operator) return follow(now, elapsed_s);
  local_path_.reset();
  moved_at_.reset();
  if (obeys_operator) return obey_operator(now, elapsed_s);
  if (track_) return stop_for(*stale);
  recovery_ = Recovery::kNone;
  tried_at_.reset();
  if (turn_rad_) return turn(now, elapsed_s);
  return {State::kIdle, idle_reason_, {}, 0.0, {}};
}

bool Controller::is_steered(time::Time now) const {
  return steered_ && abs(now - steered_->at).seconds() <= config_.operator_timeout_s;
}

/// A turn on the spot needs only a camera that sees something, so that an operator can turn a robot that has no pose.
Decision Controller::obey_operator(time::Time now, double elapsed_s) {
  recovery_ = Recovery::kNone;
  tried_at_.reset();
  blindly_rad_ += last_.turn_rad_s * elapsed_s;
  Velocity wanted = steered_->wanted;
  wanted.turn_rad_s = std::clamp(wanted.turn_rad_s, -turn_limit(), turn_limit());
  const bool is_turn = wanted.forward_m_s == 0.0;
  const auto stale = is_turn ? watchdog_.stale(now, {Input::kCamera})
                             : watchdog_.stale(now, {Input::kCamera, Input::kPose, Input::kView, Input::kMap});
  if (stale) return stop_for(*stale);
  const double free_m_s = is_turn ? 0.0 : free_speed(wanted);
  if (!is_turn && free_m_s <= 0.0) return {State::kBlocked, "an operator steers where it is not free", {}, 0.0, {}};
  if (std::abs(wanted.forward_m_s) > free_m_s) {
    wanted.turn_rad_s *= free_m_s / std::abs(wanted.forward_m_s);
    wanted.forward_m_s = std::copysign(free_m_s, wanted.forward_m_s);
  }
  return {State::kFollowing, "an operator steers", ramped(last_, wanted, elapsed_s, limits_), 0.0, {}};
}

/// Largest speed along the operator's arc from which the robot can stop before an obstacle [m/s].
double Controller::free_speed(const Velocity& wanted) const {
  const Surroundings around = map_.near(T_map_base_, planner_.fan().reach_m());
  if (wanted.forward_m_s < 0.0) {
    const double back_m_s = std::min(config_.back_up_speed_m_s, stopping_speed(kRearRoom_m, limits_));
    return may_back_up(around.obstacles) ? back_m_s : 0.0;
  }
  const double free_m = planner_.free_length_m(around.obstacles, wanted.turn_rad_s / wanted.forward_m_s);
  return std::min(stopping_speed(free_m, limits_), speed_beside(around.obstacles));
}

Decision Controller::stop_for(Input stale) const { return {State::kStopped, watchdog_.describe(stale), {}, 0.0, {}}; }

/// A disc that turns on the spot cannot collide, so a turn only needs the planner that wants it and a camera that sees
/// something.
Decision Controller::turn(time::Time now, double elapsed_s) {
  const double commanded_rad = last_.turn_rad_s * elapsed_s;
  turned_rad_ += commanded_rad;
  blindly_rad_ += commanded_rad;
  if (const auto stale = watchdog_.stale(now, {Input::kCamera, Input::kPlanner})) return stop_for(*stale);
  if (std::abs(turned_rad_) >= std::abs(*turn_rad_)) return {State::kIdle, idle_reason_, {}, 0.0, {}};
  const Velocity wanted{0.0, std::copysign(std::min(config_.look_around_rad_s, turn_limit()), *turn_rad_)};
  return {State::kFollowing, "turns on the spot", ramped(last_, wanted, elapsed_s, limits_), 0.0, {}};
}

Decision Controller::follow(time::Time now, double elapsed_s) {
  track_->advance(T_map_base_.translation(), kTrackWindow_m);
  const double to_end_m = (track_->end().translation() - T_map_base_.translation()).norm();
  const double tolerance_m = config_.goal_tolerance_m * (is_arrived_ ? 2.0 : 1.0);
  is_arrived_ = track_->left_m() <= config_.look_ahead_m && to_end_m <= tolerance_m;
  if (const auto heading_rad = track_->next_heading(yaw_of(T_map_base_)))
    return turn_first(wrapped(*heading_rad - yaw_of(T_map_base_)), elapsed_s);
  if (is_arrived_) return align(elapsed_s);
  const Surroundings around = map_.near(T_map_base_, planner_.fan().reach_m());
  local_path_ = find_local_path(around);
  const Recovery next = next_phase(around.obstacles, now);
  if (next != recovery_) enter(next, now);
  return recovery_ == Recovery::kNone ? drive(around.obstacles, elapsed_s) : recover(elapsed_s);
}

/// Turns to the next of the headings at the path's beginning, at a constant rate.
Decision Controller::turn_first(double error_rad, double elapsed_s) {
  local_path_.reset();
  moved_at_.reset();
  recovery_ = Recovery::kNone;
  const Velocity wanted{0.0, std::copysign(turn_limit(), error_rad)};
  return {State::kFollowing, "turns as the path begins", ramped(last_, wanted, elapsed_s, limits_), 0.0, {}};
}

/// At the end of the path, turns the robot to the heading of the last pose.
Decision Controller::align(double elapsed_s) {
  local_path_.reset();
  moved_at_.reset();
  const double error_rad = wrapped(yaw_of(track_->end()) - yaw_of(T_map_base_));
  if (std::abs(error_rad) <= config_.heading_tolerance_rad) {
    set_path({}, "the path's end is reached");
    return {State::kIdle, idle_reason_, {}, 0.0, {}};
  }
  const Velocity command = ramped(last_, {0.0, turn_rate(error_rad)}, elapsed_s, limits_);
  return {State::kFollowing, "turns to the heading at the path's end", command, 0.0, {}};
}

/// Finds a free path towards a point some distance ahead on the planner's path; otherwise towards a point beyond a
/// possible obstacle, or towards a nearer point.
std::optional<LocalPath> Controller::find_local_path(const Surroundings& around) const {
  for (const double share : {1.0, 2.0, 0.5}) {
    if (auto local_path = planner_.choose(around, goal_ahead(share * config_.look_ahead_m), local_path_))
      return local_path;
  }
  return std::nullopt;
}

Decision Controller::drive(const Obstacles& obstacles, double elapsed_s) const {
  Velocity wanted;
  if (local_path_->heading_rad != 0.0) {
    wanted.turn_rad_s = turn_rate(local_path_->heading_rad);
  } else {
    wanted.forward_m_s = speed_limit(*local_path_, obstacles);
    wanted.turn_rad_s = local_path_->curvature_per_m * wanted.forward_m_s;
  }
  Decision decision{State::kFollowing, "follows the path", ramped(last_, wanted, elapsed_s, limits_), 0.0, {}};
  for (const PlanarPose& T_base_pose : local_path_->poses) decision.local_path.push_back(T_map_base_ * T_base_pose);
  return decision;
}

/// Speed [m/s] from which the robot can stop before the end of the planner's path, of the free local path, and of the
/// arc on which it drives until it has steered.
double Controller::speed_limit(const LocalPath& local_path, const Obstacles& obstacles) const {
  double limit = most_speed();
  const double most_rad_s = kTurnShare * turn_limit();
  if (std::abs(local_path.curvature_per_m) * limit > most_rad_s)
    limit = most_rad_s / std::abs(local_path.curvature_per_m);
  limit = std::min(limit, std::max(kCreep_m_s, stopping_speed(track_->left_m(), limits_)));
  limit = std::min(limit, stopping_speed(local_path.free_length_m, limits_));
  if (last_.forward_m_s > kCreep_m_s) {
    const double ahead_m = planner_.free_length_m(obstacles, last_.turn_rad_s / last_.forward_m_s);
    limit = std::min(limit, stopping_speed(ahead_m, limits_));
  }
  return std::min(limit, speed_beside(obstacles));
}

/// Largest speed with this much room to what is ahead [m/s].
double Controller::speed_beside(const Obstacles& obstacles) const {
  const double room_m = std::max(0.0, nearest_ahead(obstacles) - limits_.radius_m);
  const double share = config_.slowest_share + (1.0 - config_.slowest_share) * room_m / config_.slow_within_m;
  return std::min(1.0, share) * most_speed();
}

double Controller::turn_limit() const {
  const double most = std::min(config_.turn_limit_rad_s, limits_.max_turn_rate_rad_s);
  return are_views_weak_ ? std::min(config_.weak_turn_rad_s, most) : most;
}

double Controller::turn_rate(double error_rad) const {
  const double rate = std::max(kTurnGain * std::abs(error_rad), kSlowTurn_rad_s);
  return std::copysign(std::min(rate, turn_limit()), error_rad);
}

Controller::Recovery Controller::next_phase(const Obstacles& obstacles, time::Time now) {
  const double phase_s = (now - phase_began_).seconds();
  const PlanarPose T_phase_base = T_map_phase_.inverse() * T_map_base_;
  switch (recovery_) {
    case Recovery::kNone:
      if (!local_path_) return has_tried() ? Recovery::kNoPath : Recovery::kWaiting;
      if (is_stuck(now)) return has_tried() || !may_back_up(obstacles) ? Recovery::kStuck : Recovery::kBackingUp;
      return Recovery::kNone;
    case Recovery::kWaiting:
      if (local_path_) return Recovery::kNone;
      if (phase_s < config_.patience_s) return Recovery::kWaiting;
      return may_back_up(obstacles) ? Recovery::kBackingUp : Recovery::kTurning;
    case Recovery::kBackingUp:
      if (T_phase_base.translation().norm() < config_.back_up_m && phase_s < kPhasePatience_s && may_back_up(obstacles))
        return Recovery::kBackingUp;
      tried_at_ = T_map_phase_.translation();
      return local_path_ ? Recovery::kNone : Recovery::kTurning;
    case Recovery::kTurning:
      if (local_path_) return Recovery::kNone;
      if (std::abs(yaw_of(T_phase_base)) < config_.recovery_turn_rad && phase_s < kPhasePatience_s)
        return Recovery::kTurning;
      tried_at_ = T_map_base_.translation();
      return Recovery::kNoPath;
    case Recovery::kNoPath: return local_path_ ? Recovery::kNone : Recovery::kNoPath;
    case Recovery::kStuck: return Recovery::kStuck;
  }
  return Recovery::kNone;
}

void Controller::enter(Recovery phase, time::Time now) {
  recovery_ = phase;
  phase_began_ = now;
  T_map_phase_ = T_map_base_;
  turns_left_ = bearing(goal_ahead(config_.look_ahead_m)) >= 0.0;
  moved_at_.reset();
}

Decision Controller::recover(double elapsed_s) const {
  Decision decision{State::kFollowing, "", ramped(last_, recovery_velocity(), elapsed_s, limits_), 0.0, {}};
  switch (recovery_) {
    case Recovery::kTurning: decision.reason = "no free path: looks around"; break;
    case Recovery::kBackingUp: decision.reason = "no free path: backs up"; break;
    case Recovery::kNoPath:
      decision.state = State::kBlocked;
      decision.reason = "no free path along the planner's path";
      break;
    case Recovery::kStuck:
      decision.state = State::kBlocked;
      decision.reason = "no progress, although the path looks free";
      break;
    default: decision.reason = "no free path: waits";
  }
  return decision;
}

/// A blocked robot turns to where it wants to go, so that it sees when the path is free again.
Velocity Controller::recovery_velocity() const {
  const double aside_rad = bearing(goal_ahead(config_.look_ahead_m));
  switch (recovery_) {
    case Recovery::kTurning: return {0.0, turns_left_ ? turn_limit() : -turn_limit()};
    case Recovery::kBackingUp:
      return {-std::min({config_.back_up_speed_m_s, most_speed(), stopping_speed(kRearRoom_m, limits_)}), 0.0};
    case Recovery::kNoPath: return {0.0, std::abs(aside_rad) > kAside_rad ? turn_rate(aside_rad) : 0.0};
    default: return {};
  }
}

/// True when the mapper has seen the area behind the robot to be free, and no obstacle is there now.
bool Controller::may_back_up(const Obstacles& obstacles) const {
  const double radius_m = limits_.radius_m + config_.fan.margin_m;
  const Eigen::Vector2d behind(-kRearRoom_m, 0.0);
  const bool is_touched = std::any_of(obstacles.begin(), obstacles.end(), [&](const Eigen::Vector2d& p) {
    return (p - behind).norm() < std::min(radius_m, p.norm() - PathFan::kNearer_m);
  });
  if (is_touched) return false;
  const std::array<double, 3> sides{-limits_.radius_m, 0.0, limits_.radius_m};
  return std::all_of(sides.begin(), sides.end(), [&](double y) {
    return map_.is_known_free(T_map_base_ * Eigen::Vector2d(behind.x() - limits_.radius_m, y));
  });
}

/// True near the place where recovery has failed.
bool Controller::has_tried() const {
  return tried_at_ && (T_map_base_.translation() - *tried_at_).norm() < config_.back_up_m + kMoved_m;
}

/// True when the robot has tried to move for longer than progress_timeout_s without progress.
bool Controller::is_stuck(time::Time now) {
  const Eigen::Vector2d& here = T_map_base_.translation();
  if (!moved_at_ || (here - moved_to_).norm() > kMoved_m) {
    moved_at_ = now;
    moved_to_ = here;
  }
  return (now - *moved_at_).seconds() > config_.progress_timeout_s;
}

}  // namespace lapis::controller
