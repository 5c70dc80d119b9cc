#include "planner/core/spectral/weighted_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace lapis::planner {
namespace {

constexpr double kSymmetry = 1e-9;  // relative to the norm of the matrix

double mean_eigenvalue(const Information& information, const Eigen::LLT<Information>& factor, Criterion criterion) {
  switch (criterion) {
    case Criterion::kD: return std::exp(2.0 * factor.matrixLLT().diagonal().array().log().mean());
    case Criterion::kA: {
      const auto size = information.rows();
      return static_cast<double>(size) / factor.solve(Information::Identity(size, size)).trace();
    }
    case Criterion::kT: return information.diagonal().mean();
    case Criterion::kE:
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(information, Eigen::EigenvaluesOnly).eigenvalues()[0];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Sets of connected nodes (union-find).
class Components {
 public:
  explicit Components(std::size_t nodes) : parent_(nodes) { std::iota(parent_.begin(), parent_.end(), 0); }

  std::size_t of(std::size_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::size_t> parent_;
};

std::vector<WeightedEdge> merged(std::vector<WeightedEdge> edges) {
  for (WeightedEdge& edge : edges) {
    if (edge.a > edge.b) std::swap(edge.a, edge.b);
  }
  // The sort is stable, so that the weights of parallel edges are added in the given order.
  std::stable_sort(edges.begin(), edges.end(), [](const WeightedEdge& left, const WeightedEdge& right) {
    return std::pair(left.a, left.b) < std::pair(right.a, right.b);
  });
  std::vector<WeightedEdge> result;
  for (const WeightedEdge& edge : edges) {
    if (!result.empty() && result.back().a == edge.a && result.back().b == edge.b)
      result.back().weight += edge.weight;
    else
      result.push_back(edge);
  }
  return result;
}

std::vector<std::uint64_t> sorted_keyframes(std::uint64_t keyframe, std::span<const KeyframeEdge> edges) {
  std::vector<std::uint64_t> ids{keyframe};
  for (const KeyframeEdge& edge : edges) {
    ids.push_back(edge.from);
    ids.push_back(edge.to);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::size_t place_of(const std::vector<std::uint64_t>& sorted, std::uint64_t id) {
  return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), id) - sorted.begin());
}

std::vector<std::uint64_t> connected_keyframes(std::uint64_t keyframe, std::span<const KeyframeEdge> edges) {
  const std::vector<std::uint64_t> ids = sorted_keyframes(keyframe, edges);
  Components components(ids.size());
  for (const KeyframeEdge& edge : edges) components.join(place_of(ids, edge.from), place_of(ids, edge.to));
  const std::size_t wanted = components.of(place_of(ids, keyframe));
  std::vector<std::uint64_t> connected;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (components.of(i) == wanted) connected.push_back(ids[i]);
  }
  return connected;
}

}  // namespace

std::optional<double> edge_weight(const Information& information, Criterion criterion) {
  if (information.size() == 0 || !information.allFinite()) return std::nullopt;
  if (!information.isApprox(information.transpose(), kSymmetry)) return std::nullopt;
  const Eigen::LLT<Information> factor(information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const double weight = mean_eigenvalue(information, factor, criterion);
  return weight > 0.0 ? std::optional(weight) : std::nullopt;
}

std::optional<GraphError> edge_error(int node_count, const WeightedEdge& edge) {
  const bool has_nodes = std::min(edge.a, edge.b) >= 0 && std::max(edge.a, edge.b) < node_count;
  const bool has_weight = edge.weight > 0.0 && std::isfinite(edge.weight);
  if (has_nodes && has_weight && edge.a != edge.b) return std::nullopt;
  if (!has_nodes) return GraphError{"an edge names a node that is not there"};
  if (edge.a == edge.b) return GraphError{"an edge joins a node to itself"};
  return GraphError{"the weight of an edge is not positive and finite"};
}

std::variant<WeightedGraph, GraphError> WeightedGraph::make(int node_count, std::vector<WeightedEdge> edges) {
  if (node_count < 1) return GraphError{"the graph has no node"};
  Components components(index(node_count));
  for (const WeightedEdge& edge : edges) {
    if (auto error = edge_error(node_count, edge)) return *error;
    components.join(index(edge.a), index(edge.b));
  }
  for (int node = 1; node < node_count; ++node) {
    if (components.of(index(node)) != components.of(0)) return GraphError{"the graph is not connected"};
  }
  return WeightedGraph(node_count, merged(std::move(edges)));
}

std::optional<int> KeyframeGraph::node_of(std::uint64_t keyframe) const {
  const std::size_t place = place_of(keyframes, keyframe);
  if (place == keyframes.size() || keyframes[place] != keyframe) return std::nullopt;
  return static_cast<int>(place);
}

std::variant<KeyframeGraph, GraphError> component_of(std::uint64_t keyframe, std::span<const KeyframeEdge> edges,
                                                     Criterion criterion) {
  std::vector<std::uint64_t> ids = connected_keyframes(keyframe, edges);
  std::vector<WeightedEdge> weighted;
  for (const KeyframeEdge& edge : edges) {
    if (!std::binary_search(ids.begin(), ids.end(), edge.from)) continue;
    const auto weight = edge_weight(edge.information, criterion);
    if (!weight) return GraphError{"the information of an edge is not positive definite"};
    const auto from = place_of(ids, edge.from), to = place_of(ids, edge.to);
    weighted.push_back({static_cast<int>(from), static_cast<int>(to), *weight});
  }
  auto graph = WeightedGraph::make(static_cast<int>(ids.size()), std::move(weighted));
  if (auto* error = std::get_if<GraphError>(&graph)) return *error;
  return KeyframeGraph{std::get<WeightedGraph>(std::move(graph)), std::move(ids)};
}

}  // namespace lapis::planner
