#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "slam/core/graph/block_cholesky.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Which nodes the edges of a pose graph connect, as indices into `nodes`, and which nodes are free: all but the first
/// node of each connected part.
struct PoseGraphTopology {
  struct Edge {
    std::size_t from = 0, to = 0;
  };
  std::vector<Edge> edges;
  std::vector<std::size_t> part;  ///< index of the first node of a node's part, by node
  std::vector<int> free;          ///< index among the free nodes, by node; -1: fixed
  int free_count = 0;
};

/// Throws std::invalid_argument when an edge names a node that the graph lacks, or the same node twice, and when two
/// nodes have the same id.
PoseGraphTopology pose_graph_topology(const PoseGraphSnapshot& graph);

/// Indices of the edges at each node, in the order of the edges.
std::vector<std::vector<std::size_t>> edges_by_node(const PoseGraphTopology& topology);

/// Off-diagonal blocks of the normal equations of a graph's free nodes.
struct FreePairs {
  std::vector<BlockPair> pairs;
  std::vector<int> of_edge;  ///< index into `pairs`, by edge; -1 without weight or where an end is fixed
};
FreePairs free_pairs(const PoseGraphTopology& topology, const std::vector<double>& weights);

/// Finds the index of a node in `nodes` by its id; nothing when the graph lacks it.
class NodePlaces {
 public:
  explicit NodePlaces(const PoseGraphSnapshot& graph);
  std::optional<std::size_t> find(std::uint64_t id) const;

 private:
  std::vector<std::pair<std::uint64_t, std::size_t>> sorted_;
};

}  // namespace lapis::slam
