#include "planner/core/exploration/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kProgress_m = 0.3;         // nearer by less is no progress
constexpr double kMetresPerTurn_rad = 0.5;  // turning towards the final heading is progress, too
constexpr double kNearEnough_m = 1.0;       // to a place that itself cannot be reached
constexpr double kPathTolerance_m = 1.0;    // of the path that has been driven already

double distance(const Pose2& a, const Pose2& b) { return (a.p_map - b.p_map).norm(); }

double turn(const Pose2& a, const Pose2& b) {
  return std::abs(std::remainder(a.yaw_rad - b.yaw_rad, 2.0 * std::numbers::pi));
}

// What is left to do: distance, and the turn where the robot is near.
double remaining(const Pose2& robot, const Pose2& goal) {
  return distance(robot, goal) + kMetresPerTurn_rad * turn(robot, goal);
}

// Of the cells that can be reached; the robot may have started where it cannot get back to, as beside a wall.
std::optional<Cell> nearest_reached(const PlanningGrid& grid, const CostTree& tree, const Eigen::Vector2d& place_map) {
  const Cell middle = grid.cell_of(place_map);
  const int reach = static_cast<int>(kNearEnough_m / grid.resolution_m());
  std::optional<Cell> nearest;
  for (Cell step{0, -reach}; step.y <= reach; ++step.y) {
    for (step.x = -reach; step.x <= reach; ++step.x) {
      const Cell c = middle + step;
      if (tree.cost_m(c) && (!nearest || distance(c, middle) < distance(*nearest, middle))) nearest = c;
    }
  }
  return nearest;
}

bool has_frontier_at(const Surroundings& surroundings, const Eigen::Vector2d& target_map, double radius_m) {
  const auto& frontiers = surroundings.frontiers().frontiers();
  return std::any_of(frontiers.begin(), frontiers.end(), [&](const auto& entry) {
    const auto& cells = entry.second.cells;
    return std::any_of(cells.begin(), cells.end(),
                       [&](Cell c) { return (surroundings.grid().center_of(c) - target_map).norm() <= radius_m; });
  });
}

}  // namespace

void Explorer::start() {
  if (state_ == State::kDone || state_ == State::kFailed || state_ == State::kIdle) memory_.clear();
  empty_decisions_ = 0;
  decided_at_.reset();
  lost_at_.reset();
  enter(State::kExploring, "started");
}

void Explorer::stop() {
  drop_goal();
  enter(State::kIdle, "stopped");
}

void Explorer::pause() {
  drop_goal();
  enter(State::kPaused, "paused");
}

void Explorer::return_home() {
  drop_goal();
  enter(State::kReturning, "asked to return");
}

void Explorer::forget_map() {
  drop_goal();
  memory_.clear();
  looks_.clear();
  home_.reset();
  last_tracked_.reset();
  decided_at_.reset();
  empty_decisions_ = 0;
  if (state_ == State::kRecovering) enter(interrupted_, "slam has begun another map");
  if (state_ == State::kReturning) enter(State::kFailed, "the map in which it started is gone");
}

void Explorer::enter(State state, std::string reason) {
  state_ = state;
  reason_ = std::move(reason);
}

void Explorer::set_path(std::vector<Pose2> path) {
  path_ = std::move(path);
  ++path_number_;
}

void Explorer::drop_goal() {
  goal_.reset();
  if (!path_.empty()) set_path({});
}

bool Explorer::step(const Report& report, const Surroundings* surroundings) {
  if (report.robot && !home_) home_ = report.robot;
  if (report.robot && report.tracking == Tracking::kTracking) last_tracked_ = report.robot;
  const bool is_active = state_ == State::kExploring || state_ == State::kReturning || state_ == State::kRecovering;
  if (!is_active) return false;
  if (!home_) {
    reason_ = "waits for slam's first pose";
    return false;
  }
  if (report.tracking != Tracking::kTracking || state_ == State::kRecovering) {
    recover(report, surroundings);
    return false;
  }
  if (surroundings == nullptr || !report.robot) {
    reason_ = "waits for the map";
    return false;
  }
  if (state_ == State::kReturning) {
    go_home(report, *surroundings);
    return false;
  }
  return explore(report, *surroundings);
}

bool Explorer::explore(const Report& report, const Surroundings& surroundings) {
  judge_looks(surroundings, report.now);
  const bool is_due = !decided_at_ || (report.now - *decided_at_).seconds() >= config_.replan_period_s;
  if (!goal_) return is_due;
  if (has_arrived(*report.robot)) {
    note_arrival(report.now);
    drop_goal();
    return true;
  }
  if (report.is_blocked || is_stuck(report)) {
    memory_.add_failure(goal_->target_map, report.now);
    reason_ = report.is_blocked ? "the way was blocked" : "no progress";
    drop_goal();
    return true;
  }
  if (!is_path_free(*report.robot, surroundings.grid())) return true;
  return is_due;
}

void Explorer::note_arrival(time::Time now) {
  if (goal_->kind == CandidateKind::kRevisit) return memory_.add_failure(goal_->target_map, now);  // not for ever
  looks_.push_back({goal_->target_map, now + time::Duration::from_seconds(config_.settle_s)});
  memory_.leave_alone(looks_.back().target_map, looks_.back().due);
}

bool Explorer::has_arrived(const Pose2& robot) const {
  return distance(robot, goal_->pose) <= config_.goal_tolerance_m &&
         turn(robot, goal_->pose) <= config_.goal_tolerance_rad;
}

bool Explorer::is_stuck(const Report& report) {
  const double left = remaining(*report.robot, goal_->pose);
  if (left < goal_->nearest_m - kProgress_m) {
    goal_->nearest_m = left;
    goal_->progress_at = report.now;
  }
  return (report.now - goal_->progress_at).seconds() > config_.progress_timeout_s;
}

// From the robot on; cells that it stands in or has behind it do not matter.
bool Explorer::is_path_free(const Pose2& robot, const PlanningGrid& grid) const {
  const auto nearest = std::min_element(path_.begin(), path_.end(), [&](const Pose2& a, const Pose2& b) {
    return distance(robot, a) < distance(robot, b);
  });
  return std::all_of(nearest, path_.end(), [&](const Pose2& pose) {
    return distance(robot, pose) < kPathTolerance_m || grid.is_traversable(grid.cell_of(pose.p_map));
  });
}

// A frontier that is still there after it has been looked at is glass, or noise.
void Explorer::judge_looks(const Surroundings& surroundings, time::Time now) {
  while (!looks_.empty() && looks_.front().due <= now) {
    if (has_frontier_at(surroundings, looks_.front().target_map, surroundings.grid().resolution_m()))
      memory_.add_failure(looks_.front().target_map, now);
    looks_.erase(looks_.begin());
  }
}

Memory Explorer::memory(time::Time now) const {
  Memory memory;
  memory.left_alone = memory_.left_alone(now);
  memory.radius_m = config_.memory.radius_m;
  if (goal_) memory.goal = goal_->pose;
  return memory;
}

void Explorer::take(const Decision& decision, time::Time now) {
  if (state_ != State::kExploring) return;
  decided_at_ = now;
  if (decision.chosen) {
    const Candidate& chosen = decision.candidates[*decision.chosen];
    empty_decisions_ = 0;
    const bool is_new = !goal_ || (goal_->target_map - chosen.target_map).norm() > config_.memory.radius_m;
    if (is_new)
      goal_ = Goal{chosen.goal, chosen.target_map, chosen.kind, remaining(chosen.way.front(), chosen.goal), now};
    goal_->pose = chosen.goal;
    goal_->target_map = chosen.target_map;
    goal_->kind = chosen.kind;
    const bool is_revisit = chosen.kind == CandidateKind::kRevisit;
    reason_ = is_revisit ? "revisits an old place" : "drives to frontier " + std::to_string(chosen.frontier);
    return set_path(poses_along(chosen.points, config_.path_spacing_m, chosen.goal.yaw_rad));
  }
  drop_goal();
  reason_ = "no frontier can be driven to";
  if (!looks_.empty() || memory_.forgive(now)) return;
  if (++empty_decisions_ < config_.confirmations) return;
  if (config_.returns_home) return enter(State::kReturning, "nothing is left that can be reached");
  enter(State::kDone, "nothing is left that can be reached");
}

void Explorer::recover(const Report& report, const Surroundings* surroundings) {
  if (report.tracking == Tracking::kTracking) {
    lost_at_.reset();
    drop_goal();
    return enter(interrupted_, "slam tracks again");
  }
  if (state_ != State::kRecovering) {
    drop_goal();
    interrupted_ = state_;
    lost_at_ = report.now;
    enter(State::kRecovering, report.tracking == Tracking::kLost ? "slam is lost" : "slam reckons by wheels alone");
  }
  if ((report.now - *lost_at_).seconds() > config_.lost_timeout_s) {
    drop_goal();
    return enter(State::kFailed,
                 "slam has not tracked for " + std::to_string(std::lround(config_.lost_timeout_s)) + " s");
  }
  const bool can_drive = report.tracking == Tracking::kDeadReckoning && report.robot && last_tracked_;
  if (can_drive && surroundings != nullptr && path_.empty()) drive_to(*last_tracked_, report, *surroundings);
}

void Explorer::go_home(const Report& report, const Surroundings& surroundings) {
  if (!goal_)
    goal_ = Goal{*home_, home_->p_map, CandidateKind::kFrontier, remaining(*report.robot, *home_), report.now};
  const bool is_there = !path_.empty() && distance(*report.robot, path_.back()) <= config_.goal_tolerance_m;
  if (is_there || is_stuck(report)) {
    const std::string trouble = path_.empty() ? "no way back is known" : "it gets no nearer to where it started";
    drop_goal();
    return is_there ? enter(State::kDone, "is back where it started") : enter(State::kFailed, trouble);
  }
  const bool is_due = !decided_at_ || (report.now - *decided_at_).seconds() >= config_.replan_period_s;
  if (!is_due) return;
  decided_at_ = report.now;
  if (path_.empty() || report.is_blocked || !is_path_free(*report.robot, surroundings.grid()))
    drive_to(*home_, report, surroundings);
}

void Explorer::drive_to(const Pose2& to, const Report& report, const Surroundings& surroundings) {
  const PlanningGrid& grid = surroundings.grid();
  const CostTree tree = grow_cost_tree(grid, config_.path, {grid.cell_of(report.robot->p_map)});
  const auto end = nearest_reached(grid, tree, to.p_map);
  if (!end) {
    reason_ = "no way back is known";
    if (!path_.empty()) set_path({});
    return;
  }
  std::vector<Eigen::Vector2d> points = points_of(grid, straightened(grid, config_.path, tree.path_to(*end)));
  points.front() = report.robot->p_map;
  set_path(poses_along(points, config_.path_spacing_m, to.yaw_rad));
}

}  // namespace lapis::planner
