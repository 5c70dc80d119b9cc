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

  bool operator==(const WheelCalibration&) const = default;
};

/// Learns the calibration from motions that vision knows as well: Gaussian beliefs in both scales, each motion one
/// measurement (a Kalman filter of constants); the noise is the root of the mean squared innovation in its sigmas,
/// where kPriorMotions say that the configuration is right. One motion never weighs for more than kMostSigmas: slip
/// says nothing of the scale. No scale is ever known better than kLeastSigma: it changes with load and floor.
class WheelCalibrator {
 public:
  static constexpr double kPriorMotions = 20.0;
  static constexpr double kMostSigmas = 4.0;
  static constexpr double kLeastSigma = 1e-3;

  /// Begins with scales of 1, known to OdometryConfig::scale_sigma.
  explicit WheelCalibrator(const OdometryConfig& config);
  /// Continues with what was saved, a little less sure: tyres wear, and it may be another robot.
  void resume(const WheelCalibration& saved);

  const WheelCalibration& belief() const { return belief_; }
  /// How the robot has moved as its wheels say, uncorrected.
  struct Walk {
    geometry::Pose T_from_to = geometry::Pose::Identity();  ///< of base_link
    double path_m = 0.0, turned_rad = 0.0;                  ///< forwards and backwards alike
  };
  /// The robot has walked so, and moved by `seen` as vision says, with this covariance (right perturbation;
  /// translation, rotation). Motions under 5 cm and 3 degrees say nothing.
  void learn(const Walk& walk, const geometry::Pose& seen, const geometry::Matrix6d& covariance);

 private:
  /// @param walked by the wheels, `seen` by vision with `variance`; `nominal` variance of the wheels' noise
  void learn(double walked, double seen, double variance, double nominal, double& scale, double& scale_variance);

  OdometryConfig config_;
  WheelCalibration belief_;
};

/// The motion as the calibration corrects it: distance and turn along it times their scales.
geometry::Pose corrected(const WheelCalibration& wheels, const geometry::Pose& motion);

}  // namespace lapis::slam
