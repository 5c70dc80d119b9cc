#include "slam/core/motion/covariance.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace lapis::slam {

using geometry::Matrix6d;

Matrix6d compound_covariance(const Matrix6d& covariance_a, const geometry::Pose& B, const Matrix6d& covariance_b) {
  // A exp(a) B exp(b) = A B exp(Ad(B^-1) a) exp(b)
  const Matrix6d move = geometry::adjoint(B.inverse());
  return move * covariance_a * move.transpose() + covariance_b;
}

double largest_sigma(const Matrix6d& covariance, int first) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.block<3, 3>(first, first));
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

}  // namespace lapis::slam
