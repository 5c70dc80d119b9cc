#include "planner/core/spectral/laplacian_factor.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include <cholmod.h>

namespace lapis::planner {
namespace {

// Least square of a pivot, of the node's degree: below, rounding has eaten the digits.
constexpr double kLeastRelativePivot = 1e-12;

// The lower triangle of the reduced Laplacian by columns, as CHOLMOD reads it.
struct ReducedLaplacian {
  explicit ReducedLaplacian(const WeightedGraph& graph);
  cholmod_sparse view();

  std::vector<int> begin, rows;
  std::vector<double> values;
};

ReducedLaplacian::ReducedLaplacian(const WeightedGraph& graph) {
  std::vector<double> degrees(index(graph.node_count()), 0.0);
  for (const WeightedEdge& edge : graph.edges()) {
    degrees[index(edge.a)] += edge.weight;
    degrees[index(edge.b)] += edge.weight;
  }
  auto edge = graph.edges().begin();
  while (edge != graph.edges().end() && edge->a == 0) ++edge;
  for (int node = 1; node < graph.node_count(); ++node) {
    begin.push_back(static_cast<int>(rows.size()));
    rows.push_back(node - 1);
    values.push_back(degrees[index(node)]);
    for (; edge != graph.edges().end() && edge->a == node; ++edge) {
      rows.push_back(edge->b - 1);
      values.push_back(-edge->weight);
    }
  }
  begin.push_back(static_cast<int>(rows.size()));
}

cholmod_sparse ReducedLaplacian::view() {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = begin.size() - 1;
  matrix.nzmax = rows.size();
  matrix.p = begin.data();
  matrix.i = rows.data();
  matrix.x = values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

// LL' by columns.
struct Cholmod {
  explicit Cholmod(ReducedLaplacian& laplacian) {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    // Nested dissection keeps the paths to the root short; minimum degree makes long ones of the ends of a chain.
    common.method[0].ordering = CHOLMOD_METIS;
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;  // LL': finds a matrix that is not positive definite
    common.quick_return_if_not_posdef = 1;
    cholmod_sparse matrix = laplacian.view();
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

double d_optimality(int node_count, double log_trees) {
  return std::exp((std::log(node_count) + log_trees) / node_count);
}

struct LaplacianFactor::Columns {
  std::vector<int> order;  // of elimination
  std::vector<int> begin{0}, rows;
  std::vector<double> values, diagonal;
};

// Column of L^-1 along its path, root first.
struct LaplacianFactor::Path {
  std::vector<int> columns;
  std::vector<double> values;
};

std::variant<LaplacianFactor, GraphError> LaplacianFactor::make(const WeightedGraph& graph) {
  Columns columns;
  if (graph.node_count() == 1) return LaplacianFactor(std::move(columns));
  ReducedLaplacian laplacian(graph);
  const Cholmod cholmod(laplacian);
  if (cholmod.factor == nullptr || cholmod.common.status < CHOLMOD_OK) throw std::bad_alloc();
  const GraphError unequal{"the Laplacian cannot be factorised: weights differ by too many orders of magnitude"};
  if (cholmod.common.status != CHOLMOD_OK) return unequal;
  const auto& factor = *cholmod.factor;
  const auto* order = static_cast<const int*>(factor.Perm);
  const auto* begin = static_cast<const int*>(factor.p);
  const auto* count = static_cast<const int*>(factor.nz);
  const auto* rows = static_cast<const int*>(factor.i);
  const auto* values = static_cast<const double*>(factor.x);
  for (std::size_t column = 0; column < factor.n; ++column) {
    const int first = begin[column], last = first + count[column];
    const double degree = laplacian.values[index(laplacian.begin[index(order[column])])];
    if (values[first] * values[first] < kLeastRelativePivot * degree) return unequal;
    columns.order.push_back(order[column] + 1);
    columns.diagonal.push_back(values[first]);
    columns.rows.insert(columns.rows.end(), rows + first + 1, rows + last);
    columns.values.insert(columns.values.end(), values + first + 1, values + last);
    columns.begin.push_back(static_cast<int>(columns.rows.size()));
  }
  return LaplacianFactor(std::move(columns));
}

LaplacianFactor::LaplacianFactor(Columns columns)
    : node_count_(static_cast<int>(columns.order.size()) + 1), order_(std::move(columns.order)),
      column_of_(order_.size() + 1, -1), begin_(std::move(columns.begin)), rows_(std::move(columns.rows)),
      values_(std::move(columns.values)), parent_(order_.size(), -1), depth_(order_.size(), 0) {
  for (std::size_t column = order_.size(); column-- > 0;) {
    column_of_[index(order_[column])] = static_cast<int>(column);
    if (begin_[column] == begin_[column + 1]) continue;
    parent_[column] = rows_[index(begin_[column])];
    depth_[column] = depth_[index(parent_[column])] + 1;
  }
  for (const int row : rows_) row_depth_.push_back(depth_[index(row)]);
  for (const double element : columns.diagonal) {
    inverse_diagonal_.push_back(1.0 / element);
    log_trees_ += 2.0 * std::log(element);
  }
}

LaplacianFactor::Path LaplacianFactor::path_of(int node) const {
  int column = column_of_[index(node)];
  if (column < 0) return {};
  const std::size_t length = index(depth_[index(column)]) + 1;
  Path path{std::vector<int>(length), std::vector<double>(length, 0.0)};
  path.values.back() = 1.0;
  double* const values = path.values.data();
  for (std::size_t depth = length; depth-- > 0; column = parent_[index(column)]) {
    const auto j = index(column);
    path.columns[depth] = column;
    const double value = values[depth] *= inverse_diagonal_[j];
    for (auto k = index(begin_[j]); k < index(begin_[j + 1]); ++k) values[row_depth_[k]] -= values_[k] * value;
  }
  return path;
}

Eigen::MatrixXd LaplacianFactor::covariance(std::span<const int> nodes) const {
  std::vector<Path> paths;
  for (const int node : nodes) paths.push_back(path_of(node));
  const auto product = [&](const Path& left, const Path& right) {
    const auto size = std::min(left.columns.size(), right.columns.size());
    const auto end = left.columns.begin() + static_cast<std::ptrdiff_t>(size);
    const auto common = std::mismatch(left.columns.begin(), end, right.columns.begin()).first - left.columns.begin();
    return Eigen::Map<const Eigen::VectorXd>(left.values.data(), common)
        .dot(Eigen::Map<const Eigen::VectorXd>(right.values.data(), common));
  };
  const auto size = std::ssize(nodes);
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      covariance(i, j) = covariance(j, i) =
          product(paths[static_cast<std::size_t>(i)], paths[static_cast<std::size_t>(j)]);
    }
  }
  return covariance;
}

Eigen::VectorXd LaplacianFactor::solve(const Eigen::VectorXd& right) const {
  const std::size_t size = order_.size();
  std::vector<double> x(size);
  for (std::size_t j = 0; j < size; ++j) x[j] = right[order_[j]];
  for (std::size_t j = 0; j < size; ++j) {
    x[j] *= inverse_diagonal_[j];
    for (auto k = index(begin_[j]); k < index(begin_[j + 1]); ++k) x[index(rows_[k])] -= values_[k] * x[j];
  }
  for (std::size_t j = size; j-- > 0;) {
    for (auto k = index(begin_[j]); k < index(begin_[j + 1]); ++k) x[j] -= values_[k] * x[index(rows_[k])];
    x[j] *= inverse_diagonal_[j];
  }
  Eigen::VectorXd result(node_count_);
  result[0] = 0.0;
  for (std::size_t j = 0; j < size; ++j) result[order_[j]] = x[j];
  return result;
}

}  // namespace lapis::planner
