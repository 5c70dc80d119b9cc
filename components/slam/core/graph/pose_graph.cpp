#include "slam/core/graph/pose_graph.hpp"

#include <Eigen/Eigenvalues>

namespace lapis::slam {

geometry::Matrix6d edge_information(const PoseGraphConfig& config, const geometry::Matrix6d& information) {
  return bounded_information(config, config.information_share * information);
}

geometry::Matrix6d bounded_information(const PoseGraphConfig& config, const geometry::Matrix6d& information) {
  const geometry::Matrix6d symmetric = 0.5 * (information + information.transpose());
  const Eigen::SelfAdjointEigenSolver<geometry::Matrix6d> solver(symmetric);
  const geometry::Vector6d values =
      solver.eigenvalues().cwiseMax(config.min_information).cwiseMin(config.max_information);
  const geometry::Matrix6d bounded = solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
  return 0.5 * (bounded + bounded.transpose());
}

}  // namespace lapis::slam
