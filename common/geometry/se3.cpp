#include "common/geometry/se3.hpp"

#include <cmath>

namespace lapis::geometry {
namespace {

// Below this angle [rad] the series expansions are exact to double precision.
constexpr double kSmallAngle = 1e-4;

// The matrix V of the closed form exp([rho, omega]) = [exp(omega), V rho].
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d W = skew(omega);
  double a = 0.5 - angle * angle / 24.0;
  double b = 1.0 / 6.0 - angle * angle / 120.0;
  if (angle > kSmallAngle) {
    a = (1.0 - std::cos(angle)) / (angle * angle);
    b = (angle - std::sin(angle)) / (angle * angle * angle);
  }
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d W;
  W << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return W;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const double half = 0.5 * angle;
  // sin(half) / angle, with its series near zero.
  const double scale = angle > kSmallAngle ? std::sin(half) / angle : 0.5 - angle * angle / 48.0;
  Eigen::Quaterniond q(std::cos(half), scale * omega.x(), scale * omega.y(), scale * omega.z());
  return q.normalized().toRotationMatrix();
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  const double scale = sine > 1e-10 ? 2.0 * std::atan2(sine, q.w()) / sine : 2.0 / q.w();
  return scale * q.vec();
}

Pose se3_exp(const Vector6d& xi) {
  Pose T = Pose::Identity();
  T.linear() = so3_exp(xi.tail<3>());
  T.translation() = left_jacobian(xi.tail<3>()) * xi.head<3>();
  return T;
}

Vector6d se3_log(const Pose& T) {
  const Eigen::Vector3d omega = so3_log(T.linear());
  Vector6d xi;
  xi << left_jacobian(omega).partialPivLu().solve(Eigen::Vector3d(T.translation())), omega;
  return xi;
}

Matrix6d adjoint(const Pose& T) {
  const Eigen::Matrix3d R = T.linear();
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = R;
  A.topRightCorner<3, 3>() = skew(T.translation()) * R;
  A.bottomRightCorner<3, 3>() = R;
  return A;
}

Pose make_pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation) {
  Pose T = Pose::Identity();
  T.linear() = rotation.normalized().toRotationMatrix();
  T.translation() = translation;
  return T;
}

Eigen::Quaterniond unit_quaternion(const Pose& T) {
  Eigen::Quaterniond q(T.linear());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return q;
}

double rotation_angle(const Eigen::Matrix3d& R) { return so3_log(R).norm(); }

bool is_valid(const Pose& T) {
  if (!T.matrix().allFinite()) return false;
  const Eigen::Matrix3d R = T.linear();
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 && R.determinant() > 0.0;
}

}  // namespace lapis::geometry
