#include "slam/core/graph/pose_graph_topology.hpp"

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
  result.part.resize(graph.nodes.size());
  std::iota(result.part.begin(), result.part.end(), 0);
  for (const PoseGraphEdge& edge : graph.edges) {
    const auto from = places.find(edge.from), to = places.find(edge.to);
    if (!from || !to || from == to) {
      throw std::invalid_argument("the edge from " + std::to_string(edge.from) + " to " + std::to_string(edge.to) +
                                  (from && to ? " is a loop on one node" : ": the graph has no such node"));
    }
    result.edges.push_back({*from, *to});
    const auto a = root_of(result.part, *from), b = root_of(result.part, *to);
    result.part[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    result.part[i] = root_of(result.part, i);
    result.free.push_back(result.part[i] == i ? -1 : result.free_count++);
  }
  return result;
}

std::vector<std::vector<std::size_t>> edges_by_node(const PoseGraphTopology& topology) {
  std::vector<std::vector<std::size_t>> result(topology.free.size());
  for (std::size_t i = 0; i < topology.edges.size(); ++i) {
    result[topology.edges[i].from].push_back(i);
    result[topology.edges[i].to].push_back(i);
  }
  return result;
}

FreePairs free_pairs(const PoseGraphTopology& topology, const std::vector<double>& weights) {
  FreePairs result;
  for (std::size_t i = 0; i < topology.edges.size(); ++i) {
    const int a = topology.free[topology.edges[i].from], b = topology.free[topology.edges[i].to];
    const bool is_pair = weights[i] > 0.0 && a >= 0 && b >= 0;
    result.of_edge.push_back(is_pair ? static_cast<int>(result.pairs.size()) : -1);
    if (is_pair) result.pairs.emplace_back(a, b);
  }
  return result;
}

}  // namespace lapis::slam
