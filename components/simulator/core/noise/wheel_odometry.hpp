#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace lapis::simulator {

/// Variances grow with the path, so that they do not depend on how often odometry is read [after Thrun, Burgard, Fox,
/// Probabilistic Robotics, 5.4]: var(distance) = a3 |ds| + a4 |dtheta|, var(turn) = a1 |dtheta| + a2 |ds|.
struct OdometryNoiseConfig {
  double turn_per_turn = 4e-4;       ///< a1 [rad2/rad], >= 0
  double turn_per_metre = 1e-4;      ///< a2 [rad2/m], >= 0
  double distance_per_metre = 4e-4;  ///< a3 [m2/m], >= 0
  double distance_per_turn = 1e-5;   ///< a4 [m2/rad], >= 0
  double wheel_sigma = 0.01;         ///< of assumed over true wheel radius, which is drawn once per run, 0 to 0.1
  double base_sigma = 0.01;          ///< of assumed over true wheel base, which is drawn once per run, 0 to 0.1
  double wheel_range = 0.0;          ///< > 0: the error is drawn uniformly from +- this instead, and not scaled
  double base_range = 0.0;           ///< the same for the wheel base
  double turn_slip = 0.0;            ///< each turn is overestimated by a share drawn from 0 to this; >= 0; not scaled
  double scale = 1.0;                ///< factor on all standard deviations, 0 to 10
};

/// Motion in one period, as odometry measures it.
struct OdometryStep {
  double distance_m = 0.0;
  double turn_rad = 0.0;
  double distance_variance = 0.0;  ///< [m2]
  double turn_variance = 0.0;      ///< [rad2]
};

/// Pose by dead reckoning: it starts at the origin, and drifts. Noise depends on the number of the step alone.
class WheelOdometry {
 public:
  WheelOdometry(const OdometryNoiseConfig& config, std::uint64_t seed);

  /// Adds the next period, in which the wheels truly rolled `distance_m` forwards and turned the robot by `turn_rad`.
  OdometryStep step(double distance_m, double turn_rad);

  const Eigen::Vector2d& position() const { return position_; }
  double yaw_rad() const { return yaw_rad_; }  ///< in [-pi, pi]
  /// Covariance of (x, y, yaw) to first order, with the contribution of systematic errors other than slip on turns.
  Eigen::Matrix3d covariance() const { return covariance_.topLeftCorner<3, 3>(); }

 private:
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  void propagate(const OdometryStep& step, double middle_yaw_rad);
  double slip_of(double turn_rad);

  OdometryNoiseConfig config_;
  std::uint64_t seed_;
  std::uint64_t steps_ = 0;
  std::uint64_t turns_ = 0;
  int turn_sign_ = 0;   // of the current turn; 0: none
  double wheel_ = 1.0;  // assumed over true radius
  double base_ = 1.0;   // assumed over true base
  Eigen::Vector2d position_{0, 0};
  double yaw_rad_ = 0.0;
  Matrix5d covariance_ = Matrix5d::Zero();  // of x, y, yaw, wheel, base
};

}  // namespace lapis::simulator
