#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "planner/core/exploration/explorer.hpp"
#include "planner/core/space/line.hpp"
#include "tests/unit/planner/hallucination/small_world.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner::test {

/// A building drawn as text ('#' wall, '.' floor, 'G' glass: a wall that is not seen, 'R' where the robot starts), a
/// robot that follows paths exactly, and a camera that sees 90 degrees and 5 m of it. Ideal, but for what a test
/// spoils.
class WalkWorld {
 public:
  explicit WalkWorld(std::vector<std::string> lines, const ExplorerConfig& explorer_config = {})
      : lines_(std::move(lines)), known_(kResolution_m), surroundings({}, mapping::SensorModel{}, kResolution_m),
        explorer(explorer_config), view_({.camera = kCamera, .columns = 16, .rows = 9, .range_m = 5.0}) {
    decision_config.method = Method::kMiOnly;
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(y); ++x) {
        if (at({x, y}) == 'R') robot.p_map = center({x, y});
      }
    }
  }

  /// Lives for so long [s], or until the explorer is at rest.
  void run(double duration_s) {
    const time::Time end = now + time::Duration::from_seconds(duration_s);
    while (now < end && explorer.state() != State::kDone && explorer.state() != State::kFailed) tick();
  }
  void tick() {
    now = now + time::Duration::from_seconds(kTick_s);
    look();
    surroundings.update_map(known_.map(), known_.flush());
    const Report report{now, tracking == Tracking::kLost ? std::nullopt : std::optional(robot), tracking, is_blocked};
    if (explorer.step(report, &surroundings)) decide_now();
    move();
  }

  char at(Cell c) const {
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
        if (at({x, y}) != '.') continue;
        ++floor;
        known += known_.at({x, y}) == mapping::kFree ? 1 : 0;
      }
    }
    return static_cast<double>(known) / floor;
  }

  static constexpr double kResolution_m = 0.25;
  static constexpr double kTick_s = 0.2;

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
    if (what == '#') known_.set(c, mapping::kOccupied);
    if (what == '.' || what == 'R') known_.set(c, mapping::kFree);
    return what == '.' || what == 'R';
  }
  void decide_now() {
    ++decisions;
    const Decision decision = decide({surroundings.grid(), surroundings.frontiers(), surroundings.field(), view_,
                                      geometry::T_base_camera({1.0, 0.0}), nullptr, nullptr, robot},
                                     explorer.memory(now), decision_config);
    explorer.take(decision, now);
  }
  /// 0.6 m/s along the path, turning at once; walls stop it.
  void move() {
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
    return what == '#' || what == 'G';
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
  int decisions = 0;
  double travelled_m = 0.0;

 private:
  View view_;
  std::uint64_t followed_ = 0;
  std::size_t next_ = 0;
};

}  // namespace lapis::planner::test
