#include "slam/core/pose_graph_topology.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lapis::slam {
namespace {

// Root of a node's tree in a forest where every node knows its parent; roots are their own (union-find).
std::size_t root_of(std::vector<std::size_t>& parents, std::size_t node) {
  while (parents[node] != node) {
    parents[node] = parents[parents[node]];
    node = parents[node];
  }
  return node;
}

}  // namespace

NodePlaces::NodePlaces(const PoseGraphSnapshot& graph) {
  sorted_.reserve(graph.nodes.size());
  for (const PoseGraphNode& node : graph.nodes) sorted_.emplace_back(node.id, sorted_.size());
  std::sort(sorted_.begin(), sorted_.end());
  for (std::size_t i = 1; i < sorted_.size(); ++i) {
    if (sorted_[i].first != sorted_[i - 1].first) continue;
    throw std::invalid_argument("node " + std::to_string(sorted_[i].first) + " appears twice");
  }
}

std::optional<std::size_t> NodePlaces::find(std::uint64_t id) const {
  const auto it = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair<std::uint64_t, std::size_t>{id, 0});
  if (it == sorted_.end() || it->first != id) return std::nullopt;
  return it->second;
}

PoseGraphTopology pose_graph_topology(const PoseGraphSnapshot& graph) {
  PoseGraphTopology result;
  const NodePlaces places(graph);
  result.component.resize(graph.nodes.size());
  std::iota(result.component.begin(), result.component.end(), 0);
  for (const PoseGraphEdge& edge : graph.edges) {
    const auto from = places.find(edge.from), to = places.find(edge.to);
    if (!from || !to || from == to) {
      throw std::invalid_argument("the edge from " + std::to_string(edge.from) + " to " + std::to_string(edge.to) +
                                  (from && to ? " is a loop on one node" : ": the graph has no such node"));
    }
    result.edges.push_back({*from, *to});
    const auto a = root_of(result.component, *from), b = root_of(result.component, *to);
    result.component[std::max(a, b)] = std::min(a, b);
  }
  int count = 0;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    result.component[i] = root_of(result.component, i);
    result.free.push_back(result.component[i] == i ? -1 : count++);
  }
  for (PoseGraphTopology::Edge& edge : result.edges) {
    const int a = result.free[edge.from], b = result.free[edge.to];
    if (a < 0 || b < 0) continue;
    edge.pair = static_cast<int>(result.pairs.size());
    result.pairs.emplace_back(a, b);
  }
  result.order = elimination_order(count, result.pairs);
  return result;
}

}  // namespace lapis::slam
