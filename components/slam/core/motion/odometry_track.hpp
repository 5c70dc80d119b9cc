#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/motion/wheel_calibration.hpp"

namespace lapis::slam {

/// Motion of the robot between two stamps, as odometry measured it.
struct OdometryMotion {
  geometry::Pose T_from_to = geometry::Pose::Identity();       ///< of base_link
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< right perturbation (translation, rotation)
  double path_m = 0.0;                                         ///< length of the path, forwards and backwards alike
  double turned_rad = 0.0;                                     ///< sum of the turns, in both directions alike
};

/// What the robot reports at a stamp.
struct OdometryReading {
  time::Time stamp;
  geometry::Pose T_odom_base = geometry::Pose::Identity();
};

/// By how many sigmas two independent measurements of the same motion disagree: the Mahalanobis length of
/// log(T_odometry^-1 * T_from_to). Its root mean square is sqrt(6) when the covariances are honest.
double disagreement(const OdometryMotion& odometry, const geometry::Pose& T_from_to,
                    const geometry::Matrix6d& covariance);

/// Wheel odometry of the recent past. Its pose drifts without bound, so only motions are taken from it. Their
/// covariance follows from OdometryConfig, because the one in the messages of most robots is a constant.
class OdometryTrack {
 public:
  static constexpr std::size_t kMostReadings = 100'000;  ///< half an hour at 50 Hz

  explicit OdometryTrack(const OdometryConfig& config) : config_(config), wheels_(WheelCalibrator(config).belief()) {}

  /// Longest time without readings after which a saved track continues [s]: that of a restart.
  static constexpr double kLongestOutage_s = 60.0;
  /// Largest motion within it that is no reset of odometry [m, rad]: Lapis stops a robot that has no pose at once.
  static constexpr double kLongestStep_m = 2.0, kLargestTurn_rad = 2.0;

  /// Readings that follow are corrected by this calibration, and covariances include its uncertainty and noise.
  void calibrate(const WheelCalibration& wheels) { wheels_ = wheels; }

  /// Adds the next reading: `T_odom_base` at `stamp`. False when it cannot be used: it is not later than the last one,
  /// or no rigid transform. A new track begins when the motion since the last reading is unknown: after a gap of more
  /// than OdometryConfig::max_gap_s, after a step faster than a robot can move (the odometry was reset), and when
  /// stamps go back by more than a second (the source was restarted). At most kMostReadings are kept.
  bool add(time::Time stamp, const geometry::Pose& T_odom_base);
  /// Continues a track that was saved, if it is not empty. The next reading may come up to kLongestOutage_s after it,
  /// and no further away than kLongestStep_m and kLargestTurn_rad: between the two the robot is taken to have moved
  /// straight. A reading at the origin, when the track has left it, is a reset.
  void resume(std::span<const OdometryReading> saved);
  /// All readings that are kept, as received.
  std::vector<OdometryReading> readings() const;
  /// Drops readings before `stamp`, except the one that interpolation at `stamp` may need.
  void forget_before(time::Time stamp);

  /// Motion between two stamps, `from` not later than `to`: interpolated between readings, and extrapolated for at most
  /// half of OdometryConfig::max_gap_s after the newest one. Nothing outside of this range.
  std::optional<OdometryMotion> between(time::Time from, time::Time to) const;
  /// The same motion as the wheels measured it, without calibration.
  std::optional<WheelCalibrator::Walk> uncorrected_between(time::Time from, time::Time to) const;
  /// T_odom_base at a stamp as the wheels measured it; known in the same range as motions.
  std::optional<geometry::Pose> pose_at(time::Time stamp) const;

 private:
  struct Reading {
    time::Time stamp;
    geometry::Pose T_odom_base;  // as received
    geometry::Pose T_corrected;  // the same track, corrected
    double path_m = 0.0;         // since the track began, forwards and backwards alike
    double turned_rad = 0.0;     // sum of the turns since then, in both directions alike
  };
  bool continues_after_outage(double elapsed_s, const geometry::Pose& T_odom_base) const;
  bool continues(time::Time stamp, const geometry::Pose& T_odom_base) const;
  std::optional<Reading> at(time::Time stamp) const;

  OdometryConfig config_;
  WheelCalibration wheels_;
  std::deque<Reading> readings_;
  bool awaits_next_ = false;  // the newest reading is of before a restart
};

}  // namespace lapis::slam
