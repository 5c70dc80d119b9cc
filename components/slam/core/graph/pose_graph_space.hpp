#pragma once

#include "common/geometry/se3.hpp"

namespace lapis::slam {

/// Poses in space, their residuals and derivatives. A pose moves by a tangent (translation v, rotation w) in the axes
/// of the map, at its own position: t + v, exp(w) R.
struct SpatialPoses {
  static constexpr int kDof = 6, kDim = 3;
  using Vector = geometry::Vector6d;
  using Matrix = geometry::Matrix6d;
  struct Pose {
    Eigen::Quaterniond rotation;
    Eigen::Vector3d position;
  };
  static Pose from_pose(const geometry::Pose& T);
  static geometry::Pose to_pose(const Pose& pose);
  static Matrix information(const geometry::Matrix6d& information) { return information; }
  static void move(Pose& pose, const Vector& step);

  /// Error of a measured relative pose: translation and twice the vector part of the unit quaternion (w >= 0) of
  /// measured^-1 * from^-1 * to. That is g2o's error in units of the tangent (Kuemmerle et al., ICRA 2011).
  static Vector residual(const Pose& from, const Pose& to, const Pose& measured);
  /// The same, with its derivative by the move of `to`.
  static Vector residual(const Pose& from, const Pose& to, const Pose& measured, Matrix& by_to);
  /// Matrix M such that the derivative by the move of `from` = -(derivative by the move of `to`) * M: M is the motion
  /// at the position of `to` that a move of `from` causes with the offset between them as its lever arm.
  static Matrix lever(const Pose& from, const Pose& to);
};

/// Poses in the plane, as g2o's SE2: rotation about z, error (translation, angle).
struct PlanarPoses {
  static constexpr int kDof = 3, kDim = 2;
  using Vector = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;
  struct Pose {
    double angle;
    Eigen::Vector2d position;
  };
  static Pose from_pose(const geometry::Pose& T);
  /// In the plane z = 0.
  static geometry::Pose to_pose(const Pose& pose);
  static Matrix information(const geometry::Matrix6d& information);
  static void move(Pose& pose, const Vector& step);
  static Vector residual(const Pose& from, const Pose& to, const Pose& measured);
  static Vector residual(const Pose& from, const Pose& to, const Pose& measured, Matrix& by_to);
  static Matrix lever(const Pose& from, const Pose& to);
};

}  // namespace lapis::slam
