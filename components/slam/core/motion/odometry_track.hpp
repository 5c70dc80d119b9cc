#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/motion/wheel_calibration.hpp"

namespace lapis::slam {

/// How the robot has moved between two stamps, as odometry says.
struct OdometryMotion {
  geometry::Pose T_from_to = geometry::Pose::Identity();       ///< of base_link
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< right perturbation (translation, rotation)
  double path_m = 0.0;                                         ///< forwards and backwards alike
  double turned_rad = 0.0;                                     ///< the same
};

/// By how many sigmas two independent measurements of the same motion disagree: the Mahalanobis length of
/// log(T_odometry^-1 * T_from_to), which for honest covariances is sqrt(6) in the root of its mean square.
double disagreement(const OdometryMotion& odometry, const geometry::Pose& T_from_to,
                    const geometry::Matrix6d& covariance);

/// Wheel odometry of the recent past. Its pose drifts without bound, so only motions are taken from it; their
/// covariance is that of OdometryConfig, because the one in the messages of most robots is a constant.
class OdometryTrack {
 public:
  static constexpr std::size_t kMostReadings = 100'000;  ///< half an hour at 50 Hz

  explicit OdometryTrack(const OdometryConfig& config) : config_(config), wheels_(WheelCalibrator(config).belief()) {}

  /// Readings that follow are corrected by this calibration, and covariances are those that it leaves.
  void calibrate(const WheelCalibration& wheels) { wheels_ = wheels; }

  /// The next reading: `T_odom_base` at `stamp`. False when it cannot be used: it is not later than the last one, or no
  /// rigid transform. A new track begins, because what happened is not known: after a gap of more than
  /// OdometryConfig::max_gap_s, after a step faster than a robot can move (wheel odometry that was set anew), and when
  /// stamps go back by more than a second (a source that began anew). At most kMostReadings are kept.
  bool add(time::Time stamp, const geometry::Pose& T_odom_base);
  /// Readings before `stamp` are not needed any more, but for the one that it may have to be interpolated from.
  void forget_before(time::Time stamp);

  /// Motion between two stamps, `from` not later than `to`; interpolated between readings, carried on for at most half
  /// of OdometryConfig::max_gap_s after the newest. None outside of what is known.
  std::optional<OdometryMotion> between(time::Time from, time::Time to) const;
  /// The same as the wheels said it, without calibration.
  std::optional<WheelCalibrator::Walk> uncorrected_between(time::Time from, time::Time to) const;
  /// T_odom_base at a stamp as the wheels said it, known as far as motions are.
  std::optional<geometry::Pose> pose_at(time::Time stamp) const;

 private:
  struct Reading {
    time::Time stamp;
    geometry::Pose T_odom_base;  // as it came
    geometry::Pose T_corrected;  // the same track, corrected
    double path_m = 0.0;         // since the track began, forwards and backwards alike
    double turned_rad = 0.0;     // the same
  };
  bool continues(time::Time stamp, const geometry::Pose& T_odom_base) const;
  std::optional<Reading> at(time::Time stamp) const;

  OdometryConfig config_;
  WheelCalibration wheels_;
  std::deque<Reading> readings_;
};

}  // namespace lapis::slam
