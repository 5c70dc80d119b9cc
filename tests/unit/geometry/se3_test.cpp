#include "common/geometry/se3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

namespace lapis::geometry {
namespace {

Vector6d random_tangent(std::mt19937& engine, double translation, double angle) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = unit(engine);
  xi.head<3>() *= translation;
  xi.tail<3>() *= angle / std::sqrt(3.0);
  return xi;
}

// The 4x4 Lie algebra element, exponentiated by Eigen's general matrix exponential: an independent reference.
Eigen::Matrix4d matrix_exponential(const Vector6d& xi) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  M.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  M.topRightCorner<3, 1>() = xi.head<3>();
  return M.exp();
}

TEST(Se3, ExponentialEqualsTheMatrixExponential) {
  std::mt19937 engine(1);
  for (const double angle : {1e-12, 1e-8, 0.9e-4, 1.1e-4, 1e-3, 0.5, 3.0}) {
    for (int i = 0; i < 20; ++i) {
      const Vector6d xi = random_tangent(engine, 2.0, angle);
      EXPECT_LT((se3_exp(xi).matrix() - matrix_exponential(xi)).cwiseAbs().maxCoeff(), 1e-12) << "angle " << angle;
    }
  }
}

TEST(Se3, LogarithmInvertsTheExponential) {
  std::mt19937 engine(2);
  for (const double angle : {1e-12, 1e-8, 1e-4, 0.5, 3.0}) {
    for (int i = 0; i < 50; ++i) {
      const Vector6d xi = random_tangent(engine, 2.0, angle);
      EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-9) << "angle " << angle;
    }
  }
}

TEST(Se3, LogarithmNearPiHasAngleNearPi) {
  const Eigen::Vector3d omega(0.0, 0.0, std::numbers::pi - 1e-9);
  EXPECT_NEAR(so3_log(so3_exp(omega)).norm(), std::numbers::pi, 1e-7);
}

TEST(Se3, AdjointMovesAPerturbationToTheOtherSide) {
  std::mt19937 engine(3);
  for (int i = 0; i < 50; ++i) {
    const Pose T = se3_exp(random_tangent(engine, 3.0, 3.0));
    const Vector6d xi = random_tangent(engine, 0.5, 0.5);
    const Pose left = se3_exp(adjoint(T) * xi) * T;
    const Pose right = T * se3_exp(xi);
    EXPECT_LT((left.matrix() - right.matrix()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_NEAR(adjoint(T).determinant(), 1.0, 1e-10);
  }
}

TEST(Se3, UnitQuaternionHasNonNegativeRealPart) {
  std::mt19937 engine(4);
  for (int i = 0; i < 50; ++i) {
    const Pose T = se3_exp(random_tangent(engine, 1.0, 3.1));
    const Eigen::Quaterniond q = unit_quaternion(T);
    EXPECT_GE(q.w(), 0.0);
    EXPECT_LT((make_pose(T.translation(), q).matrix() - T.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Se3, ValidityRefusesWhatIsNoRigidTransform) {
  EXPECT_TRUE(is_valid(Pose::Identity()));
  Pose scaled = Pose::Identity();
  scaled.linear() *= 1.01;
  EXPECT_FALSE(is_valid(scaled));
  Pose mirrored = Pose::Identity();
  mirrored.linear()(0, 0) = -1.0;
  EXPECT_FALSE(is_valid(mirrored));
  Pose not_a_number = Pose::Identity();
  not_a_number.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(not_a_number));
}

}  // namespace
}  // namespace lapis::geometry
