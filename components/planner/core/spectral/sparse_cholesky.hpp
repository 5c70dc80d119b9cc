#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace lapis::planner {

/// The lower triangle of a symmetric matrix by columns. Rows ascend; the first element of each column is the diagonal
/// one.
struct LowerTriangle {
  std::vector<int> begin{0}, rows;
  std::vector<double> values;

  std::size_t size() const { return begin.size() - 1; }
};

/// Sparse Cholesky factor L of a symmetric positive definite matrix A. It is made once and then only read, by any
/// number of threads.
///
/// Column i of L^-1 is zero except on the path from i to the root of the elimination tree (Liu, 1990). An element of
/// A^-1 is therefore the product of two such short columns, and needs no solve with the whole factor.
class SparseCholesky {
 public:
  /// The factor of an empty matrix.
  SparseCholesky() = default;
  /// Returns nothing when a pivot is so small relative to its diagonal element that rounding errors make the matrix
  /// singular.
  static std::optional<SparseCholesky> make(LowerTriangle matrix);

  std::size_t size() const { return order_.size(); }
  /// ln det A.
  double log_determinant() const { return log_determinant_; }
  /// Number of stored elements of L, without the diagonal.
  std::size_t elements() const { return values_.size(); }

  /// Elements of A^-1 at rows and columns `indices`, which may repeat; zero where an index is negative.
  Eigen::MatrixXd inverse(std::span<const int> indices) const;
  /// Solves A x = right.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  struct Path;

  void index_tree();
  Path path_of(int index) const;

  double log_determinant_ = 0.0;
  std::vector<int> order_, column_of_;  // indices in the order of elimination; position of each in that order
  std::vector<int> begin_{0}, rows_;    // of the elements below the diagonal, by columns
  std::vector<double> values_, inverse_diagonal_;
  // The elimination tree: parent of each column (-1 for a root), its depth below the root, and the depths of `rows_`.
  std::vector<int> parent_, depth_, row_depth_;
};

}  // namespace lapis::planner
