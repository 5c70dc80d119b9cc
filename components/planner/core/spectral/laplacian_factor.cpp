#include "planner/core/spectral/laplacian_factor.hpp"

#include <cmath>
#include <vector>

namespace lapis::planner {
namespace {

LowerTriangle reduced_laplacian(const WeightedGraph& graph) {
  std::vector<double> degrees(index(graph.node_count()), 0.0);
  for (const WeightedEdge& edge : graph.edges()) {
    degrees[index(edge.a)] += edge.weight;
    degrees[index(edge.b)] += edge.weight;
  }
  LowerTriangle matrix;
  auto edge = graph.edges().begin();
  while (edge != graph.edges().end() && edge->a == 0) ++edge;
  for (int node = 1; node < graph.node_count(); ++node) {
    matrix.rows.push_back(node - 1);
    matrix.values.push_back(degrees[index(node)]);
    for (; edge != graph.edges().end() && edge->a == node; ++edge) {
      matrix.rows.push_back(edge->b - 1);
      matrix.values.push_back(-edge->weight);
    }
    matrix.begin.push_back(static_cast<int>(matrix.rows.size()));
  }
  return matrix;
}

}  // namespace

double d_optimality(int node_count, double log_trees) {
  return std::exp((std::log(node_count) + log_trees) / node_count);
}

std::variant<LaplacianFactor, GraphError> LaplacianFactor::make(const WeightedGraph& graph) {
  auto factor = SparseCholesky::make(reduced_laplacian(graph));
  if (!factor) return GraphError{"the Laplacian cannot be factorised: weights differ by too many orders of magnitude"};
  return LaplacianFactor(std::move(*factor));
}

Eigen::MatrixXd LaplacianFactor::covariance(std::span<const int> nodes) const {
  std::vector<int> indices;
  for (const int node : nodes) indices.push_back(node - 1);
  return factor_.inverse(indices);
}

Eigen::VectorXd LaplacianFactor::solve(const Eigen::VectorXd& right) const {
  Eigen::VectorXd result(node_count());
  result[0] = 0.0;
  result.tail(node_count() - 1) = factor_.solve(right.tail(node_count() - 1));
  return result;
}

}  // namespace lapis::planner
