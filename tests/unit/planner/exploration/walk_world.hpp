#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "planner/core/exploration/explorer.hpp"
#include "planner/core/methods/methods.hpp"
#include "planner/core/space/line.hpp"
#include "tests/unit/planner/exploration/walk_slam.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner::test {

/// Of a target: three, one from another side, and one more where the map around it has become another.
inline constexpr int kMostFailures = 5;

/// A building drawn as text ('#' wall, '.' floor, 'G' a wall that is not seen, 'W' a window: seen through, not passed,
/// 'O' an obstacle that only the obstacle layer knows, 'N' one that it knows only while the robot is near and that
/// hides what is there from the map, 'D' a door that looks closed from farther than a metre, though there is a view of
/// what lies behind, 'F' one of a place behind glass of which each view shows something else, 'R' where the robot
/// starts), a robot that follows paths exactly, and a camera that sees 90 degrees and 5 m of it. Ideal, but for what a
/// test spoils.
class WalkWorld {
 public:
  explicit WalkWorld(std::vector<std::string> lines, const ExplorerConfig& explorer_config = {})
      : lines_(std::move(lines)), known_(kResolution_m), surroundings({}, mapping::SensorModel{}, kResolution_m),
        explorer(explorer_config), view_({.camera = kCamera, .columns = 16, .rows = 9, .range_m = 5.0}) {
    decision_config.method = make_method("mi_only");
    decision_config.gaps.least_nats = 0.0;  // the map has one layer
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(y); ++x) {
        if (at({x, y}) == 'R') robot.p_map = center({x, y});
      }
    }
  }

  /// Lives for so long [s], or until the explorer is at rest.
  void run(double duration_s) {
    const time::Time end = now + time::Duration::from_seconds(duration_s);
    while (now < end && explorer.state() != State::kDone && explorer.state() != State::kGaveUp &&
           explorer.state() != State::kFailed)
      tick();
  }
  void tick() {
    now = now + time::Duration::from_seconds(kTick_s);
    slam_.track(robot);
    look();
    surroundings.update_map(known_.map(), known_.flush());
    surroundings.update_obstacles(obstacles(), now);
    const bool had_goal = explorer.memory(now).goal.has_value();
    const bool is_decision_wanted = explorer.step(report(), &surroundings);
    if (had_goal && !explorer.memory(now).goal && is_failure(explorer.reason()))
      count(target_, GoalMemoryConfig{}.radius_m, failures_);
    count_failed_views();
    if (is_decision_wanted) decide_now();
    const Pose2 before = robot;
    move();
    const bool is_idle =
        explorer.state() == State::kExploring && robot.p_map == before.p_map && robot.yaw_rad == before.yaw_rad;
    idle_s_ = is_idle ? idle_s_ + kTick_s : 0.0;
    longest_idle_s = std::max(longest_idle_s, idle_s_);
  }
  /// The map and the robot in it move by so many cells, as after a loop closure.
  void jump(Cell by) {
    std::map<Cell, std::int8_t> moved;
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(y); ++x) {
        moved[Cell{x, y} + offset_ + by] = known_.at(Cell{x, y} + offset_);
        known_.set(Cell{x, y} + offset_, mapping::kUnknown);
      }
    }
    for (const auto& [c, value] : moved) known_.set(c, value);
    offset_ = offset_ + by;
    robot.p_map += kResolution_m * Eigen::Vector2d(by.x, by.y);
    slam_.move(kResolution_m * Eigen::Vector2d(by.x, by.y));
  }
  /// How often the robot set out, and failed, for the target for which it did so most.
  int most_failures() const { return most_of(failures_); }
  /// How often it arrived, and its view failed, at the target at which it did so most.
  int most_failed_views() const { return most_of(failed_views_); }

  /// In the map.
  char at(Cell in_map) const {
    const Cell c = in_map - offset_;
    if (c.y < 0 || c.y >= height() || c.x < 0 || c.x >= width(c.y)) return ' ';
    return lines_[static_cast<std::size_t>(height() - 1 - c.y)][static_cast<std::size_t>(c.x)];
  }
  void set(Cell c, char what) {
    lines_[static_cast<std::size_t>(height() - 1 - c.y)][static_cast<std::size_t>(c.x)] = what;
  }
  /// Share of the floor that is known to be free.
  double explored_share() const {
    int floor = 0, known = 0;
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(y); ++x) {
        if (at(Cell{x, y} + offset_) != '.') continue;
        ++floor;
        known += known_.at(Cell{x, y} + offset_) == mapping::kFree ? 1 : 0;
      }
    }
    return static_cast<double>(known) / floor;
  }

  static constexpr double kResolution_m = 0.25;
  static constexpr double kTick_s = 0.2;
  static constexpr double kNearDoor_m = 1.0;

 private:
  int height() const { return static_cast<int>(lines_.size()); }
  int width(int y) const { return static_cast<int>(lines_[static_cast<std::size_t>(height() - 1 - y)].size()); }
  static Eigen::Vector2d center(Cell c) { return kResolution_m * Eigen::Vector2d(c.x + 0.5, c.y + 0.5); }

  void look() {
    const Cell from = surroundings.grid().cell_of(robot.p_map);
    for (int degree = -45; degree <= 45; ++degree) {
      const double angle = robot.yaw_rad + degree * std::numbers::pi / 180.0;
      const Eigen::Vector2d end = robot.p_map + 5.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      walk_line(from, surroundings.grid().cell_of(end), [&](Cell c, double) { return see(c); });
    }
  }
  bool see(Cell c) {
    const char what = at(c);
    if (what == 'F') return see_noise(c);
    const bool looks_closed = what == 'D' && (center(c - offset_) - robot.p_map).norm() > kNearDoor_m;
    if (what == '#' || looks_closed) known_.set(c, mapping::kOccupied);
    const bool is_seen_through = what == '.' || what == 'R' || what == 'W' || what == 'D';
    if (is_seen_through && !looks_closed) known_.set(c, mapping::kFree);
    return is_seen_through;
  }
  bool see_noise(Cell c) {
    constexpr std::array<std::int8_t, 3> kStates{mapping::kFree, mapping::kUnknown, mapping::kOccupied};
    known_.set(c, kStates[noise_() % kStates.size()]);
    return true;
  }
  Report report() const {
    return {now, tracking == Tracking::kLost ? std::nullopt : std::optional(robot), tracking, is_blocked, drift_m};
  }
  void decide_now() {
    ++decisions;
    if (decided_at_) least_decision_time_s = std::min(least_decision_time_s, (now - *decided_at_).seconds());
    decided_at_ = now;
    const auto known = slam_.knowledge(kResolution_m);
    const Decision decision = decide({surroundings.grid(), surroundings.frontiers(), surroundings.field(), view_,
                                      geometry::T_base_camera({1.0, 0.0}), known ? &known->graph : nullptr,
                                      known ? &known->landmarks : nullptr, robot},
                                     explorer.memory(now), decision_config);
    explorer.take(decision, report());
    if (decision.chosen) target_ = decision.candidates[*decision.chosen].target_map;
  }
  static bool is_failure(const std::string& reason) {
    return reason == "the path was blocked" || reason == "the path took too long" || reason == "it did not get on";
  }
  using Counts = std::vector<std::pair<Eigen::Vector2d, int>>;
  static void count(const Eigen::Vector2d& of, double radius_m, Counts& counts) {
    for (auto& [target, count] : counts) {
      if ((target - of).norm() > radius_m) continue;
      ++count;
      return;
    }
    counts.emplace_back(of, 1);
  }
  static int most_of(const Counts& counts) {
    int most = 0;
    for (const auto& entry : counts) most = std::max(most, entry.second);
    return most;
  }
  void count_failed_views() {
    const std::vector<FailedView> views = explorer.memory(now).failed_views;
    judged_ = std::min(judged_, views.size());  // some are forgotten, the oldest first
    for (; judged_ < views.size(); ++judged_) count(views[judged_].target_map, 0.5 * kResolution_m, failed_views_);
  }
  ObstacleGrid obstacles() const {
    ObstacleGrid grid{Eigen::Vector2d::Zero(), kResolution_m, width(0), height(), {}};
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(0); ++x) grid.cells.push_back(occupancy({x, y}));
    }
    return grid;
  }
  std::int8_t occupancy(Cell c) const {
    constexpr double kNear_m = 4.0;
    if (at(c) != 'N') return at(c) == 'O' ? 100 : 0;
    return (robot.p_map - center(c)).norm() < kNear_m ? 100 : -1;
  }
  /// 0.6 m/s along the path, turning at once; walls stop it. On the spot 0.3 rad/s.
  void move() {
    if (explorer.is_turn()) {
      robot.yaw_rad += 0.3 * kTick_s;
      return;
    }
    if (explorer.path_number() != followed_) {
      followed_ = explorer.path_number();
      next_ = 0;
    }
    double left = 0.6 * kTick_s;
    while (next_ < explorer.path().size() && left > 0.0) {
      const Pose2& to = explorer.path()[next_];
      const double step = (to.p_map - robot.p_map).norm();
      if (is_wall(to.p_map) || step > left) return;
      left -= step;
      travelled_m += step;
      robot = to;
      ++next_;
    }
  }
  bool is_wall(const Eigen::Vector2d& p) const {
    const char what = at(surroundings.grid().cell_of(p));
    return what == '#' || what == 'G' || what == 'W' || what == 'O' || what == 'N';
  }

  std::vector<std::string> lines_;
  FlatMap known_;

 public:
  Surroundings surroundings;
  Explorer explorer;
  DecisionConfig decision_config;
  Pose2 robot;
  time::Time now;
  Tracking tracking = Tracking::kTracking;
  bool is_blocked = false;
  double drift_m = 0.0;
  int decisions = 0;
  double travelled_m = 0.0;
  double longest_idle_s = 0.0;  ///< without moving or turning while it explored
  double least_decision_time_s = std::numeric_limits<double>::infinity();  ///< from one to the next

 private:
  View view_;
  WalkSlam slam_;
  std::uint64_t followed_ = 0;
  std::size_t next_ = 0;
  Cell offset_{0, 0};
  double idle_s_ = 0.0;
  std::optional<time::Time> decided_at_;
  std::mt19937 noise_{1};
  Eigen::Vector2d target_{0, 0};
  std::size_t judged_ = 0;  ///< failed views that have been counted
  Counts failures_, failed_views_;
};

}  // namespace lapis::planner::test
