#pragma once

#include <optional>
#include <vector>

#include "slam/core/block_cholesky.hpp"
#include "slam/core/pose_graph.hpp"
#include "slam/core/pose_graph_space.hpp"
#include "slam/core/pose_graph_topology.hpp"

namespace lapis::slam {

/// Weighted least squares over the free poses of a graph: chi2 = sum of w e' Omega e over its edges, and its normal
/// equations in Gauss and Newton's approximation.
template <class Space>
class PoseGraphProblem {
 public:
  using Pose = typename Space::Pose;
  using Poses = std::vector<Pose>;

  PoseGraphProblem(const PoseGraphTopology& topology, const PoseGraphSnapshot& graph);

  static Poses poses_of(const PoseGraphSnapshot& graph);
  /// e' Omega e of each edge, without its weight.
  std::vector<double> edge_chi2(const Poses& poses) const;
  double chi2(const Poses& poses, const std::vector<double>& weights) const;

  /// Sets up the normal equations at these poses.
  void linearize(const Poses& poses, const std::vector<double>& weights);
  /// Gauss-Newton's step with damping; nothing where the equations cannot be solved.
  std::optional<Eigen::VectorXd> step(double damping);
  Poses moved(const Poses& poses, const Eigen::VectorXd& step) const;
  /// By how much the linear model's chi2 falls with a step [1].
  double predicted_decrease(const Eigen::VectorXd& step) const;

  BlockCholesky& equations() { return equations_; }

 private:
  struct Edge {
    PoseGraphTopology::Edge ends;
    Pose measured;
    typename Space::Matrix information;
  };
  void add(const Edge& edge, double weight, const Poses& poses);

  const PoseGraphTopology& topology_;
  std::vector<Edge> edges_;
  BlockCholesky equations_;
  Eigen::VectorXd gradient_;  // half of the derivative of chi2 by the free poses
};

extern template class PoseGraphProblem<SpatialPoses>;
extern template class PoseGraphProblem<PlanarPoses>;

}  // namespace lapis::slam
