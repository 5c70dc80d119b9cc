#include "slam/core/graph/pose_graph_space.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace lapis::slam {

using geometry::skew;

SpatialPoses::Pose SpatialPoses::from_pose(const geometry::Pose& T) {
  return {geometry::unit_quaternion(T), T.translation()};
}

geometry::Pose SpatialPoses::to_pose(const Pose& pose) { return geometry::make_pose(pose.position, pose.rotation); }

void SpatialPoses::move(Pose& pose, const Vector& step) {
  pose.position += step.head<3>();
  pose.rotation = (Eigen::Quaterniond(geometry::so3_exp(step.tail<3>())) * pose.rotation).normalized();
}

SpatialPoses::Vector SpatialPoses::residual(const Pose& from, const Pose& to, const Pose& measured) {
  const Eigen::Quaterniond predicted = from.rotation * measured.rotation;
  const Eigen::Quaterniond error = predicted.conjugate() * to.rotation;
  Vector result;
  result << predicted.conjugate() * (to.position - from.position) - measured.rotation.conjugate() * measured.position,
      (error.w() < 0.0 ? -2.0 : 2.0) * error.vec();
  return result;
}

SpatialPoses::Vector SpatialPoses::residual(const Pose& from, const Pose& to, const Pose& measured, Matrix& by_to) {
  const Eigen::Quaterniond predicted = from.rotation * measured.rotation;
  Eigen::Quaterniond error = predicted.conjugate() * to.rotation;
  if (error.w() < 0.0) error.coeffs() = -error.coeffs();
  const Eigen::Matrix3d A = predicted.toRotationMatrix().transpose();
  by_to.topRightCorner<3, 3>().setZero();
  by_to.bottomLeftCorner<3, 3>().setZero();
  by_to.topLeftCorner<3, 3>() = A;
  // Vector part of (1, w / 2) * q, with w in the axes of the prediction.
  by_to.bottomRightCorner<3, 3>() = (error.w() * Eigen::Matrix3d::Identity() - skew(error.vec())) * A;
  Vector result;
  result << A * (to.position - from.position) - measured.rotation.conjugate() * measured.position, 2.0 * error.vec();
  return result;
}

SpatialPoses::Matrix SpatialPoses::lever(const Pose& from, const Pose& to) {
  Matrix M = Matrix::Identity();
  M.topRightCorner<3, 3>() = -skew(to.position - from.position);
  return M;
}

PlanarPoses::Pose PlanarPoses::from_pose(const geometry::Pose& T) {
  return {std::atan2(T(1, 0), T(0, 0)), T.translation().head<2>()};
}

geometry::Pose PlanarPoses::to_pose(const Pose& pose) {
  return geometry::make_pose({pose.position.x(), pose.position.y(), 0.0},
                             Eigen::Quaterniond(Eigen::AngleAxisd(pose.angle, Eigen::Vector3d::UnitZ())));
}

PlanarPoses::Matrix PlanarPoses::information(const geometry::Matrix6d& information) {
  constexpr std::array kKept = {0, 1, 5};
  Matrix result;
  for (int r = 0; r < kDof; ++r) {
    for (int c = 0; c < kDof; ++c) {
      result(r, c) = information(kKept[static_cast<std::size_t>(r)], kKept[static_cast<std::size_t>(c)]);
    }
  }
  return result;
}

void PlanarPoses::move(Pose& pose, const Vector& step) {
  pose.position += step.head<2>();
  pose.angle = std::remainder(pose.angle + step.z(), 2.0 * std::numbers::pi);
}

PlanarPoses::Vector PlanarPoses::residual(const Pose& from, const Pose& to, const Pose& measured) {
  Matrix unused;
  return residual(from, to, measured, unused);
}

PlanarPoses::Vector PlanarPoses::residual(const Pose& from, const Pose& to, const Pose& measured, Matrix& by_to) {
  const Eigen::Matrix2d A = Eigen::Rotation2Dd(-from.angle - measured.angle).toRotationMatrix();
  by_to.setZero();
  by_to.topLeftCorner<2, 2>() = A;
  by_to(2, 2) = 1.0;
  Vector result;
  result << A * (to.position - from.position) - Eigen::Rotation2Dd(-measured.angle) * measured.position,
      std::remainder(to.angle - from.angle - measured.angle, 2.0 * std::numbers::pi);
  return result;
}

PlanarPoses::Matrix PlanarPoses::lever(const Pose& from, const Pose& to) {
  const Eigen::Vector2d d = to.position - from.position;
  Matrix M = Matrix::Identity();
  M.topRightCorner<2, 1>() << -d.y(), d.x();
  return M;
}

}  // namespace lapis::slam
