#pragma once

#include <variant>
#include <vector>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// Which `kept` of the candidate edges (loop closures, covisibility) to keep beside the fixed ones (odometry), which
/// connect all nodes. 0 <= kept <= number of candidates.
struct SparsificationProblem {
  int node_count = 0;
  std::vector<WeightedEdge> fixed, candidates;
  int kept = 0;
};

struct Sparsification {
  std::vector<int> kept;     ///< indices of candidates, ascending
  double value = 0.0;        ///< objective of the graph of the fixed and these
  double upper_bound = 0.0;  ///< no choice of as many candidates has a larger objective
};

struct MacConfig {
  int max_iterations = 20;     ///< of Frank and Wolfe, >= 1
  double relative_gap = 1e-4;  ///< between bound and relaxed objective at which to stop, >= 0
  int roundings = 8;           ///< Madow's systematic samples that are tried beside the nearest choice, >= 0
};

/// Objective: the algebraic connectivity, relaxed to weights x w, 0 <= x <= 1, maximised by Frank and Wolfe's method
/// and rounded (MAC: Doherty, Rosen and Leonard, 2022). Deterministic. Fails where the fixed edges do not connect the
/// nodes.
std::variant<Sparsification, GraphError> maximize_connectivity(const SparsificationProblem& problem,
                                                               const MacConfig& config = {});

/// Objective: ln S, the log-determinant of the reduced Laplacian, which is submodular: the greedy choice gains at least
/// 1 - 1/e of the best gain (Nemhauser, Wolsey and Fisher, 1978). Deterministic. Fails as above.
std::variant<Sparsification, GraphError> maximize_log_trees(const SparsificationProblem& problem);

/// What chooses the edges of a graph that is too large.
enum class Sparsifier { kNone, kMac, kLogTrees };

/// The graph with `max_edges` edges at most: the heaviest spanning tree, which stays whatever the number, and the edges
/// that the sparsifier keeps beside it. Deterministic.
std::variant<WeightedGraph, GraphError> sparsify(const WeightedGraph& graph, Sparsifier sparsifier, int max_edges);

}  // namespace lapis::planner
