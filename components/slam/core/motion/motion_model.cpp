#include "slam/core/motion/motion_model.hpp"

#include <algorithm>

#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {

using geometry::Matrix6d;
using geometry::Pose;

void MotionModel::resume(time::Time stamp, const RelativeCamera& camera, std::span<const OdometryReading> odometry) {
  last_ = Last{stamp, camera, std::nullopt};
  odometry_.resume(odometry);
}

void MotionModel::update(const Map& map, time::Time stamp, const RelativeCamera& camera) {
  Last next{stamp, camera, std::nullopt};
  const double elapsed_s = last_ ? (stamp - last_->stamp).seconds() : 0.0;
  if (elapsed_s > 0.0 && elapsed_s <= max_gap_s_) {
    const Pose T_map_last = map.keyframe(last_->camera.reference).T_map_camera * last_->camera.T_reference_camera;
    const Pose T_map_camera = map.keyframe(camera.reference).T_map_camera * camera.T_reference_camera;
    next.velocity = geometry::se3_log(T_map_last.inverse() * T_map_camera) / elapsed_s;
    if (last_->velocity) note_acceleration(*next.velocity - *last_->velocity, elapsed_s);
  }
  last_ = next;
}

std::optional<std::pair<time::Time, Pose>> MotionModel::last_pose(const Map& map) const {
  if (!last_) return std::nullopt;
  const auto& [reference, T_reference_camera, covariance] = last_->camera;
  return std::pair(last_->stamp, Pose(map.keyframe(reference).T_map_camera * T_reference_camera));
}

std::optional<MotionModel::Expected> MotionModel::expect(const Map& map, time::Time stamp) const {
  if (const auto reckoned = dead_reckon(stamp)) {
    return Expected{map.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera,
                    reckoned->covariance};
  }
  if (!last_) return std::nullopt;
  const double elapsed_s = (stamp - last_->stamp).seconds();
  if (elapsed_s < 0.0 || elapsed_s > max_gap_s_) return std::nullopt;
  const Pose T_map_last = map.keyframe(last_->camera.reference).T_map_camera * last_->camera.T_reference_camera;
  const Magnitude change =
      last_->velocity ? Magnitude{acceleration_.m * elapsed_s, acceleration_.rad * elapsed_s} : assumed_speed_;
  const geometry::Vector6d moved = last_->velocity.value_or(geometry::Vector6d::Zero()) * elapsed_s;
  geometry::Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(change.m * elapsed_s), Eigen::Vector3d::Constant(change.rad * elapsed_s);
  return Expected{T_map_last * geometry::se3_exp(moved),
                  last_->camera.covariance + Matrix6d(sigma.cwiseAbs2().asDiagonal())};
}

// Strong accelerations are forgotten slowly: who has moved jerkily will do so again.
void MotionModel::note_acceleration(const geometry::Vector6d& change, double elapsed_s) {
  constexpr double kForgets = 0.95;
  constexpr Magnitude kLeast{1.0, 2.0};
  const auto renew = [&](double& acceleration, double now, double least) {
    acceleration = std::max({least, kForgets * acceleration, now / elapsed_s});
  };
  renew(acceleration_.m, change.head<3>().norm(), kLeast.m);
  renew(acceleration_.rad, change.tail<3>().norm(), kLeast.rad);
}

std::optional<Pose> MotionModel::predict(const Map& map, time::Time stamp) const {
  const auto expected = expect(map, stamp);
  if (!expected) return std::nullopt;
  return expected->T_map_camera;
}

std::optional<Pose> MotionModel::motion_through(const Map& map, time::Time stamp, const Pose& T_map_camera,
                                                time::Time to) const {
  const auto last = last_pose(map);
  const double elapsed_s = last ? (stamp - last->first).seconds() : 0.0;
  if (!(elapsed_s > 0.0 && elapsed_s <= max_gap_s_)) return std::nullopt;
  const geometry::Vector6d moved = geometry::se3_log(last->second.inverse() * T_map_camera);
  return geometry::se3_exp(moved * ((to - stamp).seconds() / elapsed_s));
}

std::optional<RelativeCamera> MotionModel::dead_reckon(time::Time stamp) const {
  if (!last_) return std::nullopt;
  const auto motion = odometry_between(last_->stamp, stamp);
  if (!motion) return std::nullopt;
  const auto& [reference, T_reference_camera, covariance] = last_->camera;
  return RelativeCamera{reference, T_reference_camera * motion->T_from_to,
                        compound_covariance(covariance, motion->T_from_to, motion->covariance)};
}

std::optional<OdometryMotion> MotionModel::odometry_between(time::Time from, time::Time to) const {
  auto motion = odometry_.between(from, to);
  if (!motion) return std::nullopt;
  const Pose T_camera_base = T_base_camera_.inverse();
  motion->T_from_to = T_camera_base * motion->T_from_to * T_base_camera_;
  const Matrix6d move = geometry::adjoint(T_camera_base);
  motion->covariance = move * motion->covariance * move.transpose();
  return motion;
}

void MotionModel::learn_wheels(time::Time from, time::Time to, const Pose& T_from_to, const Matrix6d& covariance) {
  const auto walked = odometry_.uncorrected_between(from, to);
  if (!walked) return;
  const Matrix6d move = geometry::adjoint(T_base_camera_);
  wheels_.learn(*walked, T_base_camera_ * T_from_to * T_base_camera_.inverse(), move * covariance * move.transpose());
  odometry_.calibrate(wheels_.belief());
}

void MotionModel::resume_wheels(const WheelCalibration& wheels) {
  wheels_.resume(wheels);
  odometry_.calibrate(wheels_.belief());
}

}  // namespace lapis::slam
