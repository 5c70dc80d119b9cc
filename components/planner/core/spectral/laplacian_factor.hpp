#pragma once

#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// D-optimality of a graph of n nodes: (n S)^(1/n), the product of its non-zero Laplacian eigenvalues to the power 1/n,
/// from ln S, S = det of the reduced Laplacian (weighted number of spanning trees). Zhang et al. 2024, eq. 6-8.
double d_optimality(int node_count, double log_trees);

/// Sparse Cholesky factor L of a graph's reduced Laplacian A: the Laplacian without row and column of node 0, the
/// anchor. Made once per version of the graph and only read afterwards, by any number of threads.
///
/// Column i of L^-1 is zero except on the path from i to the root of the elimination tree (Liu, 1990). So an element of
/// A^-1 is the product of two such short columns, and needs no solve with the whole factor.
class LaplacianFactor {
 public:
  /// Fails where the weights are so unequal that rounding makes the matrix singular.
  static std::variant<LaplacianFactor, GraphError> make(const WeightedGraph& graph);

  int node_count() const { return node_count_; }
  /// ln S: natural logarithm of det A.
  double log_trees() const { return log_trees_; }
  double d_optimality() const { return planner::d_optimality(node_count_, log_trees_); }
  /// Number of elements of L that are stored.
  std::size_t size() const { return values_.size(); }

  /// Elements of A^-1 at rows and columns `nodes`, which may repeat; zero at the anchor. Element (i, i) is the
  /// effective resistance between node i and the anchor: with weights in [1/m^2] the variance of the node's position
  /// [m^2].
  Eigen::MatrixXd covariance(std::span<const int> nodes) const;
  /// x with A x = right where the anchor's element of `right` is ignored and that of x is 0. One element per node.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  struct Columns;
  struct Path;
  explicit LaplacianFactor(Columns columns);

  Path path_of(int node) const;

  int node_count_ = 0;
  double log_trees_ = 0.0;
  std::vector<int> order_, column_of_;  // nodes in the order of elimination; place of each node there, -1: the anchor
  std::vector<int> begin_, rows_;       // of the elements below the diagonal, by columns
  std::vector<double> values_, inverse_diagonal_;
  // The elimination tree: parent of each column (-1 of a root), edges between it and its root, the same of `rows_`.
  std::vector<int> parent_, depth_, row_depth_;
};

}  // namespace lapis::planner
