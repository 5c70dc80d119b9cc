#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <variant>

#include <Eigen/Core>

#include "planner/core/spectral/sparse_cholesky.hpp"
#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// D-optimality of a graph of n nodes: (n S)^(1/n), the product of its non-zero Laplacian eigenvalues to the power 1/n,
/// where S is the determinant of the reduced Laplacian (the weighted number of spanning trees) [Zhang et al. 2024,
/// eq. 6-8].
/// @param log_trees ln S
double d_optimality(int node_count, double log_trees);

/// Sparse Cholesky factor of a graph's reduced Laplacian A, which is the Laplacian without the row and column of node
/// 0, the anchor. It is made once per version of the graph and then only read, by any number of threads.
class LaplacianFactor {
 public:
  /// Fails when the weights differ so much that rounding errors make the matrix singular.
  static std::variant<LaplacianFactor, GraphError> make(const WeightedGraph& graph);

  int node_count() const { return static_cast<int>(factor_.size()) + 1; }
  /// ln S: natural logarithm of det A.
  double log_trees() const { return factor_.log_determinant(); }
  double d_optimality() const { return planner::d_optimality(node_count(), log_trees()); }
  /// Number of stored elements of the factor.
  std::size_t size() const { return factor_.elements(); }

  /// Elements of A^-1 at the rows and columns `nodes`, which may repeat; zero at the anchor. Element (i, i) is the
  /// effective resistance between node i and the anchor: with weights in [1/m^2], it is the variance of the node's
  /// position [m^2].
  Eigen::MatrixXd covariance(std::span<const int> nodes) const;
  /// Solves A x = right. The anchor's element of `right` is ignored, and that of x is 0. One element per node.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  explicit LaplacianFactor(SparseCholesky factor) : factor_(std::move(factor)) {}

  SparseCholesky factor_;  // of nodes 1, 2, ...
};

}  // namespace lapis::planner
