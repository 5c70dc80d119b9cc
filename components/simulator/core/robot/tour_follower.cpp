#include "simulator/core/robot/tour_follower.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

namespace lapis::simulator {
namespace {

constexpr double kTurnFrom_rad = 0.7;  // error of the heading from which on the robot stops and turns
constexpr double kTurnTo_rad = 0.1;    // ... until the error is below this
constexpr double kTurnGain = 1.5;      // [1/s]
constexpr double kSlowTurn_rad_s = 0.15;
constexpr double kWindow_m = 0.6;    // length of the path ahead in which the point nearest to the robot is searched
constexpr double kArrived_m = 0.05;  // from the end of a leg at which the robot stops
constexpr double kPassed_m = 0.20;   // from the end of a leg at which it does not stop
constexpr double kSlow_m_s = 0.08;   // speed just before a stop
constexpr double kStopGain = 0.8;    // [1/s]
constexpr double kSafety_m = 0.02;   // between disc and obstacle on the line to the target
constexpr double kFollowerSample_m = 0.025;
constexpr double kShortest_m = 0.05;  // least distance of the target
constexpr double kProgress_m = 0.05;  // along the path; less does not count as progress
constexpr double kPatience_s = 20.0;  // without progress, in addition to the time for turning round

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

TourFollower::TourFollower(const NavMap& map, Tour tour, const TourConfig& config)
    : map_(&map), tour_(std::move(tour)), config_(config) {
  begin_leg(0);
}

void TourFollower::begin_leg(std::size_t leg) {
  leg_ = leg;
  along_m_.clear();
  progress_m_ = 0.0;
  if (is_finished()) return;
  const Path& path = tour_.legs[leg_].path;
  along_m_.push_back(0.0);
  for (std::size_t i = 1; i < path.size(); ++i) along_m_.push_back(along_m_.back() + (path[i] - path[i - 1]).norm());
}

bool TourFollower::is_at_end() const {
  return along_m_.back() - progress_m_ <= (tour_.legs[leg_].stops ? kArrived_m : kPassed_m);
}

DriveCommand TourFollower::command(const RobotState& robot) {
  const DriveCommand command = next_command(robot.position, robot.yaw_rad);
  watch(robot);
  return command;
}

/// Notes when the robot last came nearer to the end of the tour.
void TourFollower::watch(const RobotState& robot) {
  robot_ = robot;
  if (!mark_ || mark_->leg != leg_ || progress_m_ >= mark_->progress_m + kProgress_m)
    mark_ = {robot.stamp, leg_, progress_m_};
}

std::string TourFollower::stalled() const {
  const double patience_s = kPatience_s + std::numbers::pi / config_.max_turn_rate_rad_s;
  if (is_finished() || !mark_ || (robot_.stamp - mark_->stamp).seconds() < patience_s) return {};
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "the tour is stuck at (" << robot_.position.x() << ", "
       << robot_.position.y() << "), on the way to waypoint " << leg_ + 1 << " (" << tour_.legs[leg_].path.back().x()
       << ", " << tour_.legs[leg_].path.back().y() << "): no progress for " << std::setprecision(0) << patience_s
       << " s; move the waypoint, or make room";
  return text.str();
}

DriveCommand TourFollower::next_command(const Eigen::Vector2d& position, double yaw_rad) {
  while (!is_finished()) {
    track(position);
    if (!is_at_end()) return pursue(position, yaw_rad);
    begin_leg(leg_ + 1);
  }
  return {};
}

DriveCommand TourFollower::pursue(const Eigen::Vector2d& position, double yaw_rad) {
  const Eigen::Vector2d to_target = target(position) - position;
  const double error = wrapped(std::atan2(to_target.y(), to_target.x()) - yaw_rad);
  is_turning_ = std::abs(error) > (is_turning_ ? kTurnTo_rad : kTurnFrom_rad);
  const double limit = config_.max_turn_rate_rad_s;
  if (is_turning_) {
    const double rate = std::clamp(kTurnGain * std::abs(error), kSlowTurn_rad_s, limit);
    return {0.0, std::copysign(rate, error)};
  }
  const double curvature = 2.0 * std::sin(error) / std::max(to_target.norm(), kShortest_m);
  double speed = speed_limit_m_s(config_, map_->distance_m(position));
  if (tour_.legs[leg_].stops) speed = std::min(speed, kSlow_m_s + kStopGain * (along_m_.back() - progress_m_));
  if (speed * std::abs(curvature) > limit) speed = limit / std::abs(curvature);
  return {speed, speed * curvature};
}

/// The point of the path at the look-ahead distance, or the farthest one before it that a straight line reaches.
Eigen::Vector2d TourFollower::target(const Eigen::Vector2d& position) const {
  double ahead = std::min(config_.lookahead_m, along_m_.back() - progress_m_);
  while (ahead > kShortest_m && !is_clear(position, point_at(progress_m_ + ahead))) ahead -= kShortest_m;
  return point_at(progress_m_ + ahead);
}

bool TourFollower::is_clear(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
  const int samples = std::max(1, static_cast<int>((b - a).norm() / kFollowerSample_m));
  for (int i = 1; i <= samples; ++i) {
    if (map_->distance_m(a + (b - a) * (static_cast<double>(i) / samples)) < config_.path.radius_m + kSafety_m)
      return false;
  }
  return true;
}

/// Advances the progress to the point of the path ahead that is nearest to the robot.
void TourFollower::track(const Eigen::Vector2d& position) {
  const Path& path = tour_.legs[leg_].path;
  const double from = progress_m_;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double low = std::max(along_m_[i - 1], from), high = std::min(along_m_[i], from + kWindow_m);
    const double length = along_m_[i] - along_m_[i - 1];
    if (low > high || length <= 0) continue;
    const double foot = along_m_[i - 1] + (position - path[i - 1]).dot(path[i] - path[i - 1]) / length;
    const double along = std::clamp(foot, low, high);
    const double distance = (point_at(along) - position).norm();
    if (distance >= best) continue;
    best = distance;
    progress_m_ = along;
  }
}

Eigen::Vector2d TourFollower::point_at(double along_m) const {
  const Path& path = tour_.legs[leg_].path;
  const auto next = std::upper_bound(along_m_.begin(), along_m_.end(), along_m);
  if (next == along_m_.end()) return path.back();
  const auto i = static_cast<std::size_t>(next - along_m_.begin());  // at least 1, because the first point is at 0
  const double share = (along_m - along_m_[i - 1]) / (along_m_[i] - along_m_[i - 1]);
  return path[i - 1] + share * (path[i] - path[i - 1]);
}

}  // namespace lapis::simulator
