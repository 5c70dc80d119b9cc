#include "simulator/core/robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>

#include "common/robot/drive_response.hpp"

namespace lapis::simulator {
namespace {

constexpr std::int64_t kStep = 5'000'000;  // [ns]
constexpr double kSkin_m = 1e-4;           // kept between disc and obstacle after a contact
constexpr int kMaxPushes = 8;

Eigen::Vector2d direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

/// Chord of an arc of length 1 that turns by `angle`.
double chord(double angle) {
  const double half = 0.5 * angle;
  return std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half;
}

}  // namespace

Robot::Robot(const NavMap& map, const RobotConfig& config, const RobotState& start)
    : map_(&map), config_(config), state_(start) {
  const double room = map.distance_m(start.position);
  if (room >= config.radius_m) return;
  std::ostringstream problem;
  problem << "start pose (" << start.position.x() << ", " << start.position.y() << "): the next obstacle is "
          << std::max(room, 0.0) << " m away, the robot's radius is " << config.radius_m << " m; move the start";
  throw std::runtime_error(problem.str());
}

bool Robot::command(const DriveCommand& command, const DriveFactors& factors) {
  const bool is_sound = std::isfinite(command.speed_m_s) && std::isfinite(command.turn_rate_rad_s);
  state_.target_stamp = state_.stamp;
  state_.target = {};
  if (!is_sound) return false;
  const double v = config_.max_speed_m_s, omega = config_.max_turn_rate_rad_s;
  state_.target = {factors.speed * std::clamp(command.speed_m_s, -v, v),
                   factors.turn_rate * std::clamp(command.turn_rate_rad_s, -omega, omega)};
  return true;
}

Motion Robot::advance(time::Time until) {
  Motion motion;
  const time::Time begin = state_.stamp;
  const Eigen::Vector2d velocity = Eigen::Rotation2Dd(state_.yaw_rad) * state_.velocity;
  const double yaw = state_.yaw_rad;
  while (state_.stamp < until) {
    const time::Time timeout = state_.target_stamp + config_.command_timeout;
    if (state_.stamp >= timeout) state_.target = {};
    time::Time next = std::min(until, time::Time{(state_.stamp.nanoseconds / kStep + 1) * kStep});
    if (state_.stamp < timeout) next = std::min(next, timeout);
    const double step_s = (next - state_.stamp).seconds();
    motion.is_in_contact |= move(drive_on(step_s), step_s, motion);
    state_.stamp = next;
  }
  motion.duration_s = (state_.stamp - begin).seconds();
  if (motion.duration_s <= 0) return motion;
  const Eigen::Vector2d change = Eigen::Rotation2Dd(state_.yaw_rad) * state_.velocity - velocity;
  motion.acceleration = Eigen::Rotation2Dd(-(yaw + 0.5 * motion.turn_rad)) * change / motion.duration_s;
  motion.turn_rate_rad_s = motion.turn_rad / motion.duration_s;
  return motion;
}

Robot::Roll Robot::drive_on(double step_s) {
  const auto speed = robot::drive_response(state_.drive.speed_m_s, state_.target.speed_m_s, step_s, config_.lag_s,
                                           config_.max_acceleration_m_s2);
  const auto turn = robot::drive_response(state_.drive.turn_rate_rad_s, state_.target.turn_rate_rad_s, step_s,
                                          config_.lag_s, config_.max_turn_acceleration_rad_s2);
  state_.drive = {speed.value, turn.value};
  return {speed.integral, turn.integral};
}

/// Moves the body by one step and adds it to `motion`; true when an obstacle was in the way.
bool Robot::move(const Roll& roll, double step_s, Motion& motion) {
  const double middle = state_.yaw_rad + 0.5 * roll.turn_rad;
  const double length = chord(roll.turn_rad);
  const Eigen::Vector2d wanted = state_.position + roll.distance_m * length * direction(middle);
  const bool is_blocked = map_->distance_m(wanted) < config_.radius_m;
  const Eigen::Vector2d position = is_blocked ? nearest_free(wanted) : wanted;
  const Eigen::Vector2d moved = Eigen::Rotation2Dd(-middle) * (position - state_.position);
  motion.distance_m += is_blocked ? moved.x() / length : roll.distance_m;
  motion.slide_m += is_blocked ? moved.y() : 0.0;
  motion.turn_rad += roll.turn_rad;
  state_.velocity = Eigen::Vector2d(state_.drive.speed_m_s, 0.0);
  if (is_blocked) {
    state_.velocity = Eigen::Rotation2Dd(-0.5 * roll.turn_rad) * moved / step_s;
    const double towards_m = -roll.distance_m * direction(middle).dot(map_->gradient(wanted).stableNormalized());
    motion.push_m_s = std::max(motion.push_m_s, towards_m / step_s);
  }
  state_.position = position;
  state_.yaw_rad = std::remainder(state_.yaw_rad + roll.turn_rad, 2.0 * std::numbers::pi);
  return is_blocked;
}

/// Takes Newton steps along the gradient of the distance; the current position when they do not lead out.
Eigen::Vector2d Robot::nearest_free(const Eigen::Vector2d& wanted) const {
  Eigen::Vector2d p = wanted;
  for (int i = 0; i < kMaxPushes; ++i) {
    const double missing = config_.radius_m - map_->distance_m(p);
    if (missing <= 0) return p;
    const Eigen::Vector2d gradient = map_->gradient(p);
    p += (missing + kSkin_m) / std::max(gradient.squaredNorm(), 0.25) * gradient;
  }
  return map_->distance_m(p) >= config_.radius_m ? p : state_.position;
}

}  // namespace lapis::simulator
