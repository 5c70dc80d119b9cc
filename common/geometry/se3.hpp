#pragma once

#include <Eigen/Geometry>

namespace lapis::geometry {

/// Rigid transform. `T_a_b` takes coordinates in frame b to frame a: p_a = T_a_b * p_b.
using Pose = Eigen::Isometry3d;
/// Tangent vector of SE(3), ordered (translation, rotation): [m, m, m, rad, rad, rad].
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Exponential map of SO(3): rotation vector [rad] to rotation matrix (Rodrigues).
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& omega);
/// Logarithm of SO(3): rotation vector with angle in [0, pi].
Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);

/// Exponential map of SE(3). With right perturbation a pose moves as T * exp(xi).
Pose se3_exp(const Vector6d& xi);
/// Logarithm of SE(3), inverse of se3_exp for rotation angles below pi.
Vector6d se3_log(const Pose& T);
/// Adjoint: T * exp(xi) * T^-1 = exp(adjoint(T) * xi), for the order (translation, rotation).
Matrix6d adjoint(const Pose& T);

/// Pose from translation and quaternion; the quaternion is normalised.
Pose make_pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation);
/// Rotation as unit quaternion with w >= 0, so that equal poses print equal numbers.
Eigen::Quaterniond unit_quaternion(const Pose& T);
/// Angle of a rotation in [0, pi] rad.
double rotation_angle(const Eigen::Matrix3d& R);
/// True when every number is finite and the rotation part is orthonormal within 1e-6.
bool is_valid(const Pose& T);

}  // namespace lapis::geometry
