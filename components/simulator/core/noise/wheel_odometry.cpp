#include "simulator/core/noise/wheel_odometry.hpp"

#include <cmath>
#include <numbers>

#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

constexpr double kStraight_rad = 1e-4;    // a step that turns less ends a turn
constexpr std::uint64_t kFirstTurn = 10;  // index of the first turn's number; lower ones are drawn once per run

}  // namespace

WheelOdometry::WheelOdometry(const OdometryNoiseConfig& config, std::uint64_t seed) : config_(config), seed_(seed) {
  const Random random(seed, RandomStream::kOdometrySystematic);
  const double wheel_sigma = config.scale * config.wheel_sigma, base_sigma = config.scale * config.base_sigma;
  wheel_ = 1.0 + wheel_sigma * random.normal(0);
  base_ = 1.0 + base_sigma * random.normal(1);
  if (config.wheel_range > 0.0) wheel_ = 1.0 + random.uniform(4, -config.wheel_range, config.wheel_range);
  if (config.base_range > 0.0) base_ = 1.0 + random.uniform(5, -config.base_range, config.base_range);
  const auto variance = [](double range, double sigma) { return range > 0.0 ? range * range / 3.0 : sigma * sigma; };
  covariance_(3, 3) = variance(config.wheel_range, wheel_sigma);
  covariance_(4, 4) = variance(config.base_range, base_sigma);
}

OdometryStep WheelOdometry::step(double distance_m, double turn_rad) {
  const double length = std::abs(distance_m), turn = std::abs(turn_rad), scale2 = config_.scale * config_.scale;
  OdometryStep step;
  step.distance_variance = scale2 * (config_.distance_per_metre * length + config_.distance_per_turn * turn);
  step.turn_variance = scale2 * (config_.turn_per_turn * turn + config_.turn_per_metre * length);
  const Random random(seed_, RandomStream::kOdometry, steps_++);
  step.distance_m = wheel_ * distance_m + std::sqrt(step.distance_variance) * random.normal(0);
  step.turn_rad = slip_of(turn_rad) * wheel_ / base_ * turn_rad + std::sqrt(step.turn_variance) * random.normal(1);

  const double half = 0.5 * step.turn_rad;
  const double middle = yaw_rad_ + half;
  const double chord = std::abs(half) < 1e-6 ? step.distance_m : step.distance_m * std::sin(half) / half;
  propagate(step, middle);
  position_ += chord * Eigen::Vector2d(std::cos(middle), std::sin(middle));
  yaw_rad_ = std::remainder(yaw_rad_ + step.turn_rad, 2 * std::numbers::pi);
  return step;
}

/// Measured turn over true turn; it stays the same until the robot drives straight or turns back.
double WheelOdometry::slip_of(double turn_rad) {
  const int sign = std::abs(turn_rad) < kStraight_rad ? 0 : turn_rad > 0.0 ? 1 : -1;
  if (sign != 0 && sign != turn_sign_) ++turns_;
  turn_sign_ = sign;
  if (config_.turn_slip == 0.0 || sign == 0) return 1.0;
  return 1.0 + Random(seed_, RandomStream::kOdometrySystematic).uniform(kFirstTurn + turns_, 0.0, config_.turn_slip);
}

/// P <- F P F' + G Q G'. F has the derivatives of the pose by itself and by the parameters, G those by the step.
void WheelOdometry::propagate(const OdometryStep& step, double middle_yaw_rad) {
  const double c = std::cos(middle_yaw_rad), s = std::sin(middle_yaw_rad), ds = step.distance_m;
  Eigen::Matrix<double, 3, 2> G;
  G << c, -0.5 * ds * s, s, 0.5 * ds * c, 0, 1;
  Eigen::Matrix2d by_parameters;  // derivatives of the measured step by wheel and base
  by_parameters << ds, 0, step.turn_rad, -step.turn_rad;
  Matrix5d F = Matrix5d::Identity();
  F(0, 2) = -ds * s;
  F(1, 2) = ds * c;
  F.block<3, 2>(0, 3) = G * by_parameters;
  const Eigen::Matrix2d Q = Eigen::Vector2d(step.distance_variance, step.turn_variance).asDiagonal();
  covariance_ = F * covariance_ * F.transpose();
  covariance_.topLeftCorner<3, 3>() += G * Q * G.transpose();
}

}  // namespace lapis::simulator
