#include "planner/core/spectral/sparsification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Core>

#include "planner/core/spectral/algebraic_connectivity.hpp"
#include "planner/core/spectral/laplacian_factor.hpp"

namespace lapis::planner {
namespace {

// Tolerance of Fiedler vectors during the relaxation, where any unit vector gives a valid bound.
constexpr double kRelaxedTolerance = 1e-6;
// Number of picks between two factorisations: each pick costs a product with the vectors of all picks since the last
// one.
constexpr int kPicksPerFactor = 64;

std::optional<GraphError> problem_error(const SparsificationProblem& problem) {
  for (const WeightedEdge& edge : problem.candidates) {
    if (auto error = edge_error(problem.node_count, edge)) return error;
  }
  if (problem.kept < 0 || problem.kept > std::ssize(problem.candidates)) {
    return GraphError{"cannot keep " + std::to_string(problem.kept) + " of " +
                      std::to_string(problem.candidates.size()) + " candidate edges"};
  }
  const auto skeleton = WeightedGraph::make(problem.node_count, problem.fixed);
  const auto* error = std::get_if<GraphError>(&skeleton);
  return error == nullptr ? std::nullopt : std::optional(*error);
}

// Factor of the graph of the fixed edges and of the candidates with weights x w.
std::variant<LaplacianFactor, GraphError> factor_of(const SparsificationProblem& problem, const Eigen::VectorXd& x) {
  std::vector<WeightedEdge> edges = problem.fixed;
  for (int k = 0; k < std::ssize(problem.candidates); ++k) {
    const WeightedEdge& edge = problem.candidates[index(k)];
    if (x[k] > 0.0) edges.push_back({edge.a, edge.b, x[k] * edge.weight});
  }
  const auto graph = WeightedGraph::make(problem.node_count, std::move(edges));
  if (const auto* error = std::get_if<GraphError>(&graph)) return *error;
  return LaplacianFactor::make(std::get<WeightedGraph>(graph));
}

// v' L v, where L is the Laplacian of the edge.
double energy(const WeightedEdge& edge, const Eigen::VectorXd& v) {
  const double difference = v[edge.a] - v[edge.b];
  return edge.weight * difference * difference;
}

// 1 for the `kept` candidates of largest value, 0 for the others; of equal values, the heavier candidate comes first,
// then the earlier one.
Eigen::VectorXd largest(const SparsificationProblem& problem, const Eigen::VectorXd& values) {
  std::vector<int> order(problem.candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int left, int right) {
    const double left_weight = problem.candidates[index(left)].weight;
    const double right_weight = problem.candidates[index(right)].weight;
    return std::tuple(-values[left], -left_weight, left) < std::tuple(-values[right], -right_weight, right);
  });
  Eigen::VectorXd chosen = Eigen::VectorXd::Zero(values.size());
  for (int i = 0; i < problem.kept; ++i) chosen[order[index(i)]] = 1.0;
  return chosen;
}

// Systematic sampling by Madow (1949): candidate k is chosen when one of offset, offset + 1, ... falls into its
// interval of the cumulative sums of x.
Eigen::VectorXd systematic_sample(const Eigen::VectorXd& x, double offset) {
  Eigen::VectorXd chosen = Eigen::VectorXd::Zero(x.size());
  double sum = 0.0;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double before = std::ceil(sum - offset);
    sum += x[k];
    chosen[k] = std::ceil(sum - offset) > before ? 1.0 : 0.0;
  }
  return chosen;
}

std::vector<int> indices(const Eigen::VectorXd& chosen) {
  std::vector<int> result;
  for (int k = 0; k < chosen.size(); ++k) {
    if (chosen[k] > 0.5) result.push_back(k);
  }
  return result;
}

struct Relaxed {
  Eigen::VectorXd x;
  double upper_bound = std::numeric_limits<double>::infinity();
};

// The method of Frank and Wolfe (1956). The connectivity of any choice s is at most v' L(s) v for any unit vector v
// with sum 0.
std::variant<Relaxed, GraphError> relax(const SparsificationProblem& problem, const MacConfig& config) {
  const Eigen::Index m = std::ssize(problem.candidates);
  Relaxed relaxed;
  relaxed.x = Eigen::VectorXd::Constant(m, problem.kept / static_cast<double>(m));
  Eigen::VectorXd vector, gradient(m);
  for (int t = 0; t < config.max_iterations; ++t) {
    const auto factor = factor_of(problem, relaxed.x);
    if (const auto* error = std::get_if<GraphError>(&factor)) return *error;
    LanczosConfig lanczos;
    lanczos.tolerance = kRelaxedTolerance;
    const auto pair = algebraic_connectivity(std::get<LaplacianFactor>(factor), lanczos, vector);
    vector = pair.vector;
    for (int k = 0; k < m; ++k) gradient[k] = energy(problem.candidates[index(k)], vector);
    const Eigen::VectorXd best = largest(problem, gradient);
    double bound = gradient.dot(best);
    for (const WeightedEdge& edge : problem.fixed) bound += energy(edge, vector);
    relaxed.upper_bound = std::min(relaxed.upper_bound, bound);
    if (relaxed.upper_bound - pair.value <= config.relative_gap * pair.value) break;
    relaxed.x += 2.0 / (t + 2.0) * (best - relaxed.x);
  }
  return relaxed;
}

// Effective resistance of every candidate in a graph that grows by one candidate at a time.
class GrowingGraph {
 public:
  GrowingGraph(const SparsificationProblem& problem, LaplacianFactor factor)
      : problem_(problem), factor_(std::move(factor)), resistances_(std::ssize(problem.candidates)) {
    for (int k = 0; k < resistances_.size(); ++k) {
      const int ends[] = {problem_.candidates[index(k)].a, problem_.candidates[index(k)].b};
      const Eigen::MatrixXd covariance = factor_.covariance(ends);
      resistances_[k] = covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1);
    }
  }

  double log_trees() const { return factor_.log_trees(); }

  // w r of each candidate, which would gain ln(1 + w r); 0 for chosen candidates.
  Eigen::VectorXd shares(const Eigen::VectorXd& chosen) const {
    Eigen::VectorXd result(chosen.size());
    for (int k = 0; k < chosen.size(); ++k) {
      result[k] = (1.0 - chosen[k]) * problem_.candidates[index(k)].weight * resistances_[k];
    }
    return result;
  }

  // By Sherman and Morrison, A^-1 loses z z' with z = A^-1 a / sqrt(1/w + a' A^-1 a), where a is the edge's column of
  // incidence.
  void add(const WeightedEdge& edge) {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(problem_.node_count);
    z[edge.a] = 1.0;
    z[edge.b] = -1.0;
    z = factor_.solve(z);
    for (const Eigen::VectorXd& former : updates_) z -= former * (former[edge.a] - former[edge.b]);
    z /= std::sqrt(1.0 / edge.weight + z[edge.a] - z[edge.b]);
    for (int k = 0; k < resistances_.size(); ++k) {
      const double across = z[problem_.candidates[index(k)].a] - z[problem_.candidates[index(k)].b];
      resistances_[k] = std::max(0.0, resistances_[k] - across * across);
    }
    updates_.push_back(std::move(z));
  }

 private:
  const SparsificationProblem& problem_;
  LaplacianFactor factor_;
  Eigen::VectorXd resistances_;
  std::vector<Eigen::VectorXd> updates_;  // z of each edge added since the factorisation
};

// Moves the edges of the maximum spanning tree to the front (Kruskal's algorithm). Returns the end of the tree.
std::vector<WeightedEdge>::iterator tree_first(int node_count, std::vector<WeightedEdge>& edges) {
  std::stable_sort(edges.begin(), edges.end(),
                   [](const WeightedEdge& left, const WeightedEdge& right) { return left.weight > right.weight; });
  std::vector<int> parents(index(node_count));
  std::iota(parents.begin(), parents.end(), 0);
  const auto root_of = [&](int node) {
    while (parents[index(node)] != node) node = parents[index(node)] = parents[index(parents[index(node)])];
    return node;
  };
  return std::stable_partition(edges.begin(), edges.end(), [&](const WeightedEdge& edge) {
    const int a = root_of(edge.a), b = root_of(edge.b);
    parents[index(a)] = b;
    return a != b;
  });
}

}  // namespace

std::variant<Sparsification, GraphError> maximize_connectivity(const SparsificationProblem& problem,
                                                               const MacConfig& config) {
  if (auto error = problem_error(problem)) return *error;
  const auto relaxed = relax(problem, config);
  if (const auto* error = std::get_if<GraphError>(&relaxed)) return *error;
  const auto& [x, upper_bound] = std::get<Relaxed>(relaxed);
  std::vector<Eigen::VectorXd> choices{largest(problem, x)};
  for (int i = 0; i < config.roundings; ++i) choices.push_back(systematic_sample(x, (i + 0.5) / config.roundings));
  Sparsification result;
  result.upper_bound = upper_bound;
  for (const Eigen::VectorXd& choice : choices) {
    const auto factor = factor_of(problem, choice);
    if (const auto* error = std::get_if<GraphError>(&factor)) return *error;
    const double value = algebraic_connectivity(std::get<LaplacianFactor>(factor)).value;
    if (value <= result.value) continue;
    result.value = value;
    result.kept = indices(choice);
  }
  return result;
}

std::variant<Sparsification, GraphError> maximize_log_trees(const SparsificationProblem& problem) {
  if (auto error = problem_error(problem)) return *error;
  Eigen::VectorXd chosen = Eigen::VectorXd::Zero(std::ssize(problem.candidates));
  std::optional<GrowingGraph> graph;
  for (int picks = 0;; ++picks) {
    if (picks % kPicksPerFactor == 0 || picks == problem.kept) {
      auto factor = factor_of(problem, chosen);
      if (const auto* error = std::get_if<GraphError>(&factor)) return *error;
      graph.emplace(problem, std::get<LaplacianFactor>(std::move(factor)));
    }
    if (picks == problem.kept) break;
    Eigen::Index best = 0;
    (graph->shares(chosen) - chosen).maxCoeff(&best);
    chosen[best] = 1.0;
    graph->add(problem.candidates[static_cast<std::size_t>(best)]);
  }
  // ln S is submodular: a candidate that is not chosen gains no more in a larger graph.
  const Eigen::VectorXd gains = graph->shares(chosen).array().log1p();
  return Sparsification{indices(chosen), graph->log_trees(), graph->log_trees() + gains.dot(largest(problem, gains))};
}

std::variant<WeightedGraph, GraphError> sparsify(const WeightedGraph& graph, Sparsifier sparsifier, int max_edges) {
  if (sparsifier == Sparsifier::kNone || std::ssize(graph.edges()) <= max_edges) return graph;
  std::vector<WeightedEdge> edges = graph.edges();
  const auto end_of_tree = tree_first(graph.node_count(), edges);
  SparsificationProblem problem{graph.node_count(), {edges.begin(), end_of_tree}, {end_of_tree, edges.end()}, 0};
  problem.kept = std::max(0, max_edges - static_cast<int>(problem.fixed.size()));
  const auto result = sparsifier == Sparsifier::kMac ? maximize_connectivity(problem) : maximize_log_trees(problem);
  if (const auto* error = std::get_if<GraphError>(&result)) return *error;
  for (const int k : std::get<Sparsification>(result).kept) problem.fixed.push_back(problem.candidates[index(k)]);
  return WeightedGraph::make(problem.node_count, std::move(problem.fixed));
}

}  // namespace lapis::planner
