#include "slam/core/graph/graph_marginals.hpp"

#include <cstddef>

#include "slam/core/graph/pose_graph_problem.hpp"
#include "slam/core/graph/pose_graph_topology.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;

PoseGraphSnapshot weighted(const PoseGraphSnapshot& graph, const std::vector<double>& weights) {
  PoseGraphSnapshot result = graph;
  if (weights.empty()) return result;
  result.edges.clear();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    result.edges.push_back(graph.edges[i]);
    result.edges.back().information *= weights[i];
  }
  return result;
}

// Rotates a covariance from the axes of the map to those of the poses: rows to those of `a`, columns to those of `b`.
Matrix6d in_axes_of(const geometry::Pose& a, const geometry::Pose& b, const Matrix6d& covariance) {
  const auto turn = [](const geometry::Pose& T) {
    Matrix6d R = Matrix6d::Zero();
    R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = T.linear();
    return R;
  };
  return turn(a).transpose() * covariance * turn(b);
}

Matrix6d symmetric(const Matrix6d& matrix) { return 0.5 * (matrix + matrix.transpose()); }

}  // namespace

GraphMarginals graph_marginals(const PoseGraphSnapshot& graph, const std::vector<double>& weights) {
  const std::size_t nodes = graph.nodes.size();
  GraphMarginals result{std::vector<std::optional<Matrix6d>>(nodes), std::vector<Matrix6d>(nodes, Matrix6d::Zero())};
  if (nodes == 0) return result;
  const PoseGraphSnapshot effective = weighted(graph, weights);
  const PoseGraphTopology topology = pose_graph_topology(effective);
  result.covariances[0] = Matrix6d::Zero();
  PoseGraphProblem<SpatialPoses> problem(topology, effective);
  problem.linearize(PoseGraphProblem<SpatialPoses>::poses_of(effective), std::vector(effective.edges.size(), 1.0));
  if (!problem.factorize()) return result;
  const std::vector<Eigen::MatrixXd> diagonal = problem.inverse_diagonal();
  const auto is_free = [&](std::size_t i) { return i > 0 && topology.part[i] == 0; };
  const geometry::Pose& newest = graph.nodes.back().T_map_camera;
  const Eigen::MatrixXd column =
      is_free(nodes - 1) ? problem.inverse_columns(topology.free[nodes - 1]) : Eigen::MatrixXd();
  for (std::size_t i = 1; i < nodes; ++i) {
    if (!is_free(i)) continue;
    const geometry::Pose& T = graph.nodes[i].T_map_camera;
    const int free = topology.free[i];
    result.covariances[i] = symmetric(in_axes_of(T, T, diagonal[static_cast<std::size_t>(free)]));
    if (column.size() > 0) result.with_newest[i] = in_axes_of(T, newest, column.middleRows<6>(6 * free));
  }
  return result;
}

}  // namespace lapis::slam
