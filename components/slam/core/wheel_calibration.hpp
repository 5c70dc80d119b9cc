#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// What is known of a robot's wheels: true motion is what they say times a scale, and they are as noisy as configured
/// times `noise`.
struct WheelCalibration {
  double distance_scale = 1.0;
  double distance_variance = 0.0;  ///< of distance_scale
  double turn_scale = 1.0;
  double turn_variance = 0.0;  ///< of turn_scale
  double noise = 1.0;          ///< factor of sigma, in [0.5, 5]
  double motions = 0.0;        ///< that told the noise
};

/// Learns the calibration from motions that vision knows as well: Gaussian beliefs in both scales, each motion one
/// measurement (a Kalman filter of constants); the noise is the root of the mean squared innovation in its sigmas,
/// where kPriorMotions say that the configuration is right. One motion never weighs for more than kMostSigmas: slip
/// says nothing of the scale.
class WheelCalibrator {
 public:
  static constexpr double kPriorMotions = 20.0;
  static constexpr double kMostSigmas = 4.0;

  /// Begins with scales of 1, known to OdometryConfig::scale_sigma.
  explicit WheelCalibrator(const OdometryConfig& config);
  /// Continues with what was saved.
  WheelCalibrator(const OdometryConfig& config, const WheelCalibration& saved) : config_(config), belief_(saved) {}

  const WheelCalibration& belief() const { return belief_; }
  /// The robot has moved by `odometry` as its wheels say, uncorrected, and by `seen` as vision says, with this
  /// covariance (right perturbation; translation, rotation); both of base_link. Motions under 5 cm and 3 degrees say
  /// nothing.
  void learn(const geometry::Pose& odometry, const geometry::Pose& seen, const geometry::Matrix6d& covariance);

 private:
  /// @param walked by the wheels, `seen` by vision with `variance`; `nominal` variance of the wheels' noise
  void learn(double walked, double seen, double variance, double nominal, double& scale, double& scale_variance);

  OdometryConfig config_;
  WheelCalibration belief_;
};

/// The motion as the calibration corrects it: distance and turn along it times their scales.
geometry::Pose corrected(const WheelCalibration& wheels, const geometry::Pose& motion);

}  // namespace lapis::slam
