#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// Calibration of a robot's wheels: the true motion is the measured one times a scale, and its noise is the configured
/// one times `noise`.
struct WheelCalibration {
  double distance_scale = 1.0;
  double distance_variance = 0.0;  ///< of distance_scale
  double turn_scale = 1.0;
  double turn_variance = 0.0;  ///< of turn_scale
  double noise = 1.0;          ///< factor of the configured sigmas, in [0.5, 5]
  double motions = 0.0;        ///< number of distances and turns from which `noise` was learnt

  bool operator==(const WheelCalibration&) const = default;
};

/// Learns the calibration from motions that vision has measured, too. The belief in each scale is Gaussian, and each
/// motion is one measurement (a Kalman filter of constants). The noise is the root mean square of the innovations in
/// sigmas, with a prior of kPriorMotions innovations of one sigma, as configured. No motion counts for more than
/// kMostSigmas, because slip says nothing about the scale. The sigma of a scale never falls below kLeastSigma, because
/// scales change with load and floor.
class WheelCalibrator {
 public:
  static constexpr double kPriorMotions = 20.0;
  static constexpr double kMostSigmas = 4.0;
  static constexpr double kLeastSigma = 1e-3;

  /// Begins with scales of 1 and a sigma of OdometryConfig::scale_sigma.
  explicit WheelCalibrator(const OdometryConfig& config);
  /// Continues with a saved calibration, with slightly larger variances: tyres wear, and it may be another robot.
  void resume(const WheelCalibration& saved);

  const WheelCalibration& belief() const { return belief_; }
  /// Motion of the robot as its wheels measured it, uncorrected.
  struct Walk {
    geometry::Pose T_from_to = geometry::Pose::Identity();  ///< of base_link
    double path_m = 0.0, turned_rad = 0.0;                  ///< forwards and backwards, left and right alike
  };
  /// Learns from a motion that the wheels measured as `walk` and vision as `seen`, with this covariance (right
  /// perturbation; translation, rotation). Distances below 5 cm and turns below 0.05 rad are ignored.
  void learn(const Walk& walk, const geometry::Pose& seen, const geometry::Matrix6d& covariance);

 private:
  /// @param walked distance or turn by the wheels; `seen` the same by vision, with `variance`; `nominal` variance of
  ///   the wheels' noise as configured
  void learn(double walked, double seen, double variance, double nominal, double& scale, double& scale_variance);

  OdometryConfig config_;
  WheelCalibration belief_;
};

/// Whether distances by vision differ from those of the wheels by 2 % or more, and beyond doubt: then the wheels, or
/// the scale of depth, are not as configured. Which of them, nothing tells: a map of any scale fits all images.
bool doubts_scale(const WheelCalibration& wheels);

/// The motion with its distance and its turn multiplied by their scales.
geometry::Pose corrected(const WheelCalibration& wheels, const geometry::Pose& motion);

}  // namespace lapis::slam
