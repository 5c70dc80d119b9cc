#pragma once

#include <variant>
#include <vector>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// The problem of keeping `kept` of the candidate edges (loop closures, covisibility) besides the fixed ones
/// (odometry), which connect all nodes. 0 <= kept <= number of candidates.
struct SparsificationProblem {
  int node_count = 0;
  std::vector<WeightedEdge> fixed, candidates;
  int kept = 0;
};

struct Sparsification {
  std::vector<int> kept;     ///< indices of candidates, ascending
  double value = 0.0;        ///< objective of the graph of the fixed edges and these
  double upper_bound = 0.0;  ///< no choice of the same number of candidates has a larger objective
};

struct MacConfig {
  int max_iterations = 20;     ///< of the method of Frank and Wolfe, >= 1
  double relative_gap = 1e-4;  ///< relative gap between bound and relaxed objective at which to stop, >= 0
  int roundings = 8;           ///< number of Madow's systematic samples tried besides the nearest choice, >= 0
};

/// Objective: the algebraic connectivity, relaxed to weights x w with 0 <= x <= 1, maximised by the method of Frank and
/// Wolfe and rounded (MAC: Doherty, Rosen and Leonard, 2022). Deterministic. Fails when the fixed edges do not connect
/// the nodes.
std::variant<Sparsification, GraphError> maximize_connectivity(const SparsificationProblem& problem,
                                                               const MacConfig& config = {});

/// Objective: ln S, the log-determinant of the reduced Laplacian. It is submodular, so the greedy choice gains at least
/// 1 - 1/e of the best gain (Nemhauser, Wolsey and Fisher, 1978). Deterministic. Fails when the fixed edges do not
/// connect the nodes.
std::variant<Sparsification, GraphError> maximize_log_trees(const SparsificationProblem& problem);

/// The method that chooses the edges of a graph that is too large.
enum class Sparsifier { kNone, kMac, kLogTrees };

/// The graph with at most `max_edges` edges: the maximum spanning tree, which always stays, and the edges that the
/// sparsifier keeps besides it. Deterministic.
std::variant<WeightedGraph, GraphError> sparsify(const WeightedGraph& graph, Sparsifier sparsifier, int max_edges);

}  // namespace lapis::planner
