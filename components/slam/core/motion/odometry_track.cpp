#include "slam/core/motion/odometry_track.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "common/time/stamp_buffer.hpp"
#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

// Random walk with the path and the turn [after Thrun, Burgard, Fox, Probabilistic Robotics, 5.4], and a share of both
// for the uncertainty of the wheels' size and distance.
Matrix6d motion_covariance(const OdometryConfig& c, const WheelCalibration& wheels, double path_m, double turned_rad) {
  const double noise = squared(wheels.noise);
  const double along = noise * squared(c.distance_sigma) * path_m + wheels.distance_variance * squared(path_m);
  const double yaw = noise * (squared(c.turn_sigma) * turned_rad + squared(c.turn_sigma_per_m) * path_m) +
                     wheels.turn_variance * squared(turned_rad);
  const double least = squared(c.least_sigma);
  Matrix6d covariance = Matrix6d::Zero();
  // A robot errs sideways because its heading errs, on average over half of the path.
  covariance.diagonal() << along + least, 0.25 * yaw * squared(path_m) + least,
      squared(c.vertical_sigma) * path_m + least, squared(c.tilt_sigma) * path_m + least,
      squared(c.tilt_sigma) * path_m + least, yaw + least;
  return covariance;
}

Pose between_poses(const Pose& a, const Pose& b, double share) {
  return a * geometry::se3_exp(share * geometry::se3_log(a.inverse() * b));
}

}  // namespace

double disagreement(const OdometryMotion& odometry, const Pose& T_from_to, const Matrix6d& covariance) {
  const geometry::Vector6d error = geometry::se3_log(odometry.T_from_to.inverse() * T_from_to);
  const Matrix6d sum = odometry.covariance + covariance;
  return std::sqrt(std::max(0.0, error.dot(sum.ldlt().solve(error))));
}

bool OdometryTrack::add(time::Time stamp, const Pose& T_odom_base) {
  if (!geometry::is_valid(T_odom_base)) return false;
  if (!readings_.empty() && readings_.back().stamp - stamp > time::kRestartGap) readings_.clear();
  if (!readings_.empty() && stamp <= readings_.back().stamp) return false;
  if (!readings_.empty() && !continues(stamp, T_odom_base)) readings_.clear();
  Reading reading{stamp, T_odom_base, T_odom_base};
  if (!readings_.empty()) {
    const Pose step = corrected(wheels_, readings_.back().T_odom_base.inverse() * T_odom_base);
    reading.T_corrected = readings_.back().T_corrected * step;
    reading.path_m = readings_.back().path_m + step.translation().norm();
    reading.turned_rad = readings_.back().turned_rad + geometry::rotation_angle(step.linear());
  }
  readings_.push_back(reading);
  awaits_next_ = false;
  if (readings_.size() > kMostReadings) readings_.pop_front();
  return true;
}

void OdometryTrack::resume(std::span<const OdometryReading> saved) {
  for (const OdometryReading& reading : saved) add(reading.stamp, reading.T_odom_base);
  awaits_next_ = !readings_.empty();
}

std::vector<OdometryReading> OdometryTrack::readings() const {
  std::vector<OdometryReading> result;
  for (const Reading& reading : readings_) result.push_back({reading.stamp, reading.T_odom_base});
  return result;
}

// Whether a robot can have moved there from the newest reading.
bool OdometryTrack::continues(time::Time stamp, const Pose& T_odom_base) const {
  const double elapsed_s = (stamp - readings_.back().stamp).seconds();
  if (awaits_next_) return continues_after_outage(elapsed_s, T_odom_base);
  const Pose step = readings_.back().T_odom_base.inverse() * T_odom_base;
  return elapsed_s <= config_.max_gap_s && step.translation().norm() <= config_.max_speed_m_s * elapsed_s &&
         geometry::rotation_angle(step.linear()) <= config_.max_turn_rate_rad_s * elapsed_s;
}

bool OdometryTrack::continues_after_outage(double elapsed_s, const Pose& T_odom_base) const {
  const auto is_within = [](const Pose& T, double path_m, double turn_rad) {
    return T.translation().norm() <= path_m && geometry::rotation_angle(T.linear()) <= turn_rad;
  };
  constexpr double kOrigin_m = 0.02, kOrigin_rad = 0.02;
  const Pose& last = readings_.back().T_odom_base;
  const bool is_reset =
      is_within(T_odom_base, kOrigin_m, kOrigin_rad) && !is_within(last, 2 * kOrigin_m, 2 * kOrigin_rad);
  return elapsed_s <= kLongestOutage_s && !is_reset &&
         is_within(last.inverse() * T_odom_base, kLongestStep_m, kLargestTurn_rad);
}

void OdometryTrack::forget_before(time::Time stamp) {
  while (readings_.size() > 2 && readings_[1].stamp <= stamp) readings_.pop_front();
}

std::optional<Pose> OdometryTrack::pose_at(time::Time stamp) const {
  const auto reading = at(stamp);
  if (!reading) return std::nullopt;
  return reading->T_odom_base;
}

std::optional<OdometryTrack::Reading> OdometryTrack::at(time::Time stamp) const {
  if (readings_.size() < 2 || stamp < readings_.front().stamp) return std::nullopt;
  if ((stamp - readings_.back().stamp).seconds() > 0.5 * config_.max_gap_s) return std::nullopt;
  auto after = std::lower_bound(readings_.begin() + 1, readings_.end(), stamp,
                                [](const Reading& r, time::Time t) { return r.stamp < t; });
  if (after == readings_.end()) --after;
  const Reading& a = *(after - 1);
  const Reading& b = *after;
  const double share = (stamp - a.stamp).seconds() / (b.stamp - a.stamp).seconds();
  return Reading{stamp, between_poses(a.T_odom_base, b.T_odom_base, share),
                 between_poses(a.T_corrected, b.T_corrected, share), a.path_m + share * (b.path_m - a.path_m),
                 a.turned_rad + share * (b.turned_rad - a.turned_rad)};
}

std::optional<OdometryMotion> OdometryTrack::between(time::Time from, time::Time to) const {
  const auto a = at(from);
  const auto b = at(to);
  if (!a || !b || to < from) return std::nullopt;
  return OdometryMotion{a->T_corrected.inverse() * b->T_corrected,
                        motion_covariance(config_, wheels_, b->path_m - a->path_m, b->turned_rad - a->turned_rad),
                        b->path_m - a->path_m, b->turned_rad - a->turned_rad};
}

std::optional<WheelCalibrator::Walk> OdometryTrack::uncorrected_between(time::Time from, time::Time to) const {
  const auto a = at(from);
  const auto b = at(to);
  if (!a || !b || to < from) return std::nullopt;
  return WheelCalibrator::Walk{a->T_odom_base.inverse() * b->T_odom_base, b->path_m - a->path_m,
                               b->turned_rad - a->turned_rad};
}

}  // namespace lapis::slam
