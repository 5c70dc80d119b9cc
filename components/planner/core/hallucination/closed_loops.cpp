#include "planner/core/hallucination/closed_loops.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

namespace lapis::planner {
namespace {

constexpr double kLeastShare = 1e-9;  // of a loop's weight; a smaller remainder is a rounding error

using Weights = std::map<std::pair<int, int>, double>;  // by pair of nodes, the smaller one first

LoopName name_of(const AnalysedGraph& graph, const LoopClosure& loop) {
  return {graph.keyframes[index(loop.older)].id, graph.keyframes[index(loop.newer)].id};
}

std::vector<WeightedEdge> without(const WeightedGraph& graph, const Weights& loops) {
  std::vector<WeightedEdge> edges;
  for (WeightedEdge edge : graph.edges()) {
    const auto loop = loops.find({edge.a, edge.b});
    const double taken = loop == loops.end() ? 0.0 : loop->second;
    edge.weight -= taken;
    if (edge.weight > kLeastShare * taken) edges.push_back(edge);
  }
  return edges;
}

}  // namespace

std::vector<LoopName> names_of_loops(const AnalysedGraph& graph) {
  std::vector<LoopName> names;
  for (const LoopClosure& loop : graph.loops) names.push_back(name_of(graph, loop));
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<double> gain_of_new_loops(const AnalysedGraph& graph, std::span<const LoopName> before) {
  Weights loops;
  for (const LoopClosure& loop : graph.loops) {
    const bool is_new = !std::binary_search(before.begin(), before.end(), name_of(graph, loop));
    if (is_new) loops[{loop.older, loop.newer}] += loop.weight;
  }
  if (loops.empty()) return 0.0;
  const auto rest = WeightedGraph::make(graph.graph.node_count(), without(graph.graph, loops));
  if (std::holds_alternative<GraphError>(rest)) return std::nullopt;
  const auto factor = LaplacianFactor::make(std::get<WeightedGraph>(rest));
  if (std::holds_alternative<GraphError>(factor)) return std::nullopt;
  return graph.factor.log_trees() - std::get<LaplacianFactor>(factor).log_trees();
}

}  // namespace lapis::planner
