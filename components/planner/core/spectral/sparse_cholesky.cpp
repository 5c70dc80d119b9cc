#include "planner/core/spectral/sparse_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include <cholmod.h>

namespace lapis::planner {
namespace {

// Least squared pivot relative to its diagonal element: below it, rounding errors have destroyed the significant
// digits.
constexpr double kLeastRelativePivot = 1e-12;

std::size_t place(int i) { return static_cast<std::size_t>(i); }

cholmod_sparse view_of(LowerTriangle& triangle) {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = triangle.size();
  matrix.nzmax = triangle.rows.size();
  matrix.p = triangle.begin.data();
  matrix.i = triangle.rows.data();
  matrix.x = triangle.values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

// Factor LL', stored by columns.
struct Cholmod {
  explicit Cholmod(LowerTriangle& triangle) {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    // Nested dissection keeps the paths to the root short; minimum degree makes them long from the ends of a chain.
    common.method[0].ordering = CHOLMOD_METIS;
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;  // LL' detects a matrix that is not positive definite
    common.quick_return_if_not_posdef = 1;
    cholmod_sparse matrix = view_of(triangle);
    factor = cholmod_analyze(&matrix, &common);
    if (factor != nullptr) cholmod_factorize(&matrix, factor, &common);
  }
  ~Cholmod() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common common{};
  cholmod_factor* factor = nullptr;
};

}  // namespace

// Column of L^-1 along the path of its index to the root, in the order from the root.
struct SparseCholesky::Path {
  std::vector<int> columns;
  std::vector<double> values;
};

std::optional<SparseCholesky> SparseCholesky::make(LowerTriangle matrix) {
  SparseCholesky result;
  if (matrix.size() == 0) return result;
  const Cholmod cholmod(matrix);
  if (cholmod.factor == nullptr || cholmod.common.status < CHOLMOD_OK) throw std::bad_alloc();
  if (cholmod.common.status != CHOLMOD_OK) return std::nullopt;
  const auto& factor = *cholmod.factor;
  const auto* order = static_cast<const int*>(factor.Perm);
  const auto* begin = static_cast<const int*>(factor.p);
  const auto* count = static_cast<const int*>(factor.nz);
  const auto* rows = static_cast<const int*>(factor.i);
  const auto* values = static_cast<const double*>(factor.x);
  for (std::size_t column = 0; column < factor.n; ++column) {
    const int first = begin[column], last = first + count[column];
    const double pivot = values[first], diagonal = matrix.values[place(matrix.begin[place(order[column])])];
    if (pivot * pivot < kLeastRelativePivot * diagonal) return std::nullopt;
    result.order_.push_back(order[column]);
    result.inverse_diagonal_.push_back(1.0 / pivot);
    result.log_determinant_ += 2.0 * std::log(pivot);
    result.rows_.insert(result.rows_.end(), rows + first + 1, rows + last);
    result.values_.insert(result.values_.end(), values + first + 1, values + last);
    result.begin_.push_back(static_cast<int>(result.rows_.size()));
  }
  result.index_tree();
  return result;
}

void SparseCholesky::index_tree() {
  column_of_.assign(order_.size(), 0);
  parent_.assign(order_.size(), -1);
  depth_.assign(order_.size(), 0);
  for (std::size_t column = order_.size(); column-- > 0;) {
    column_of_[place(order_[column])] = static_cast<int>(column);
    if (begin_[column] == begin_[column + 1]) continue;
    parent_[column] = rows_[place(begin_[column])];
    depth_[column] = depth_[place(parent_[column])] + 1;
  }
  row_depth_.reserve(rows_.size());
  for (const int row : rows_) row_depth_.push_back(depth_[place(row)]);
}

SparseCholesky::Path SparseCholesky::path_of(int index) const {
  if (index < 0) return {};
  int column = column_of_[place(index)];
  const std::size_t length = place(depth_[place(column)]) + 1;
  Path path{std::vector<int>(length), std::vector<double>(length, 0.0)};
  path.values.back() = 1.0;
  double* const values = path.values.data();
  for (std::size_t depth = length; depth-- > 0; column = parent_[place(column)]) {
    const auto j = place(column);
    path.columns[depth] = column;
    const double value = values[depth] *= inverse_diagonal_[j];
    for (auto k = place(begin_[j]); k < place(begin_[j + 1]); ++k) values[row_depth_[k]] -= values_[k] * value;
  }
  return path;
}

Eigen::MatrixXd SparseCholesky::inverse(std::span<const int> indices) const {
  std::vector<Path> paths;
  for (const int index : indices) paths.push_back(path_of(index));
  // The paths of two indices begin at the root and are the same up to the column at which they part.
  const auto product = [&](const Path& left, const Path& right) {
    const auto size = std::min(left.columns.size(), right.columns.size());
    const auto end = left.columns.begin() + static_cast<std::ptrdiff_t>(size);
    const auto common = std::mismatch(left.columns.begin(), end, right.columns.begin()).first - left.columns.begin();
    return Eigen::Map<const Eigen::VectorXd>(left.values.data(), common)
        .dot(Eigen::Map<const Eigen::VectorXd>(right.values.data(), common));
  };
  const auto size = std::ssize(indices);
  Eigen::MatrixXd elements(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      elements(i, j) = elements(j, i) = product(paths[static_cast<std::size_t>(i)], paths[static_cast<std::size_t>(j)]);
    }
  }
  return elements;
}

Eigen::VectorXd SparseCholesky::solve(const Eigen::VectorXd& right) const {
  const std::size_t size = order_.size();
  std::vector<double> x(size);
  for (std::size_t j = 0; j < size; ++j) x[j] = right[order_[j]];
  for (std::size_t j = 0; j < size; ++j) {
    x[j] *= inverse_diagonal_[j];
    for (auto k = place(begin_[j]); k < place(begin_[j + 1]); ++k) x[place(rows_[k])] -= values_[k] * x[j];
  }
  for (std::size_t j = size; j-- > 0;) {
    for (auto k = place(begin_[j]); k < place(begin_[j + 1]); ++k) x[j] -= values_[k] * x[place(rows_[k])];
    x[j] *= inverse_diagonal_[j];
  }
  Eigen::VectorXd result(right.size());
  for (std::size_t j = 0; j < size; ++j) result[order_[j]] = x[j];
  return result;
}

}  // namespace lapis::planner
