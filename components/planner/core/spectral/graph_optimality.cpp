#include "planner/core/spectral/graph_optimality.hpp"

#include <array>
#include <limits>

#include "planner/core/spectral/algebraic_connectivity.hpp"

namespace lapis::planner {
namespace {

double trace(const WeightedGraph& graph) {
  double sum = 0.0;
  for (const WeightedEdge& edge : graph.edges()) sum += 2.0 * edge.weight;
  return sum;
}

/// 1/l_2 + ... + 1/l_n, the trace of the Laplacian's pseudo-inverse P G P, where G is the inverse of the reduced
/// Laplacian, with zeros at the anchor, and P removes the mean.
double trace_of_inverse(const LaplacianFactor& factor) {
  const int n = factor.node_count();
  double sum = -factor.solve(Eigen::VectorXd::Ones(n)).sum() / n;
  for (int node = 0; node < n; ++node) sum += factor.covariance(std::array{node})(0, 0);
  return sum;
}

}  // namespace

std::variant<double, GraphError> optimality(const WeightedGraph& graph, Criterion criterion) {
  const int n = graph.node_count();
  if (n < 2) return GraphError{"a graph of one node has no optimality"};
  if (criterion == Criterion::kT) return trace(graph) / n;
  const auto made = LaplacianFactor::make(graph);
  if (const auto* error = std::get_if<GraphError>(&made)) return *error;
  const auto& factor = std::get<LaplacianFactor>(made);
  switch (criterion) {
    case Criterion::kD: return factor.d_optimality();
    case Criterion::kA: return n / trace_of_inverse(factor);
    case Criterion::kE: return algebraic_connectivity(factor).value;
    case Criterion::kT: break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace lapis::planner
