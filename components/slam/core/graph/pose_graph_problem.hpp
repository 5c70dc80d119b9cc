#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slam/core/graph/block_cholesky.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/graph/pose_graph_space.hpp"
#include "slam/core/graph/pose_graph_topology.hpp"

namespace lapis::slam {

/// Weighted least squares over the free poses of a graph: chi2 = sum of w e' Omega e over its edges, and its normal
/// equations in the Gauss-Newton approximation.
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

  /// Sets up the normal equations at these poses. Their sparsity pattern is analysed again when an edge gains weight or
  /// many edges have lost theirs.
  void linearize(const Poses& poses, const std::vector<double>& weights);
  /// Gauss-Newton step with damping; nothing when the equations cannot be solved.
  std::optional<Eigen::VectorXd> step(double damping);
  Poses moved(const Poses& poses, const Eigen::VectorXd& step) const;
  /// Decrease of chi2 that the quadratic model predicts for a step: exact without damping, a lower bound with damping.
  double predicted_decrease(const Eigen::VectorXd& step) const { return -gradient_.dot(step); }
  /// Factorises the matrix of the linearised equations, without damping; false when it has no inverse.
  bool factorize() { return equations_->factorize(0.0); }
  /// Columns of the inverse that belong to a free node, and its diagonal blocks by free node. Only after a successful
  /// factorize.
  Eigen::MatrixXd inverse_columns(int free_node) const;
  std::vector<Eigen::MatrixXd> inverse_diagonal() const { return equations_->inverse_diagonal(); }

  /// chi2 of an edge that does not contribute to the poses, if their uncertainty is that of the shortest path of edges
  /// with weight between its ends: a lower bound, because other paths only reduce the uncertainty. 0 without a path.
  double contradiction(std::size_t edge, const Poses& poses, const std::vector<double>& weights) const;

 private:
  struct Edge {
    PoseGraphTopology::Edge ends;
    Pose measured;
    typename Space::Matrix information;
  };
  bool fits_pattern(const std::vector<double>& weights) const;
  void analyze(const std::vector<double>& weights);
  void add(std::size_t edge, double weight, const Poses& poses);
  std::vector<std::size_t> path(std::size_t from, std::size_t to, const std::vector<double>& weights) const;

  const PoseGraphTopology& topology_;
  std::vector<Edge> edges_;
  std::vector<std::vector<std::size_t>> edges_of_;  // by node
  FreePairs pattern_;
  std::vector<bool> is_in_pattern_;  // by edge
  std::unique_ptr<BlockCholesky> equations_;
  Eigen::VectorXd gradient_;  // half of the gradient of chi2 by the free poses
};

extern template class PoseGraphProblem<SpatialPoses>;
extern template class PoseGraphProblem<PlanarPoses>;

}  // namespace lapis::slam
