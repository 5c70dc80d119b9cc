#pragma once

#include <Eigen/Core>

#include "planner/core/spectral/candidate_gain.hpp"
#include "planner/core/spectral/laplacian_factor.hpp"
#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner::test {

/// The graph, or an exception with the error's text.
WeightedGraph make_graph(int node_count, std::vector<WeightedEdge> edges);
LaplacianFactor make_factor(const WeightedGraph& graph);
CandidateGain make_gain(const LaplacianFactor& factor, const HallucinatedGraph& candidate);

/// Key-frames of three laps of one round: each sees the next two, and two of the next lap. Mean degree 6.7; weights
/// 50-150, seeded.
WeightedGraph three_laps(int node_count);

/// Chain with `extra` edges between any two nodes; weights 0.5-20.
WeightedGraph random_graph(int node_count, int extra, unsigned seed);

/// Path of 8 new nodes from the newest key-frame, and 4 loop edges from it to key-frames spread over the graph, each
/// a place.
HallucinatedGraph path_with_loops(int graph_nodes, unsigned seed);

/// The graph with the candidate's nodes, its certain edges and those to `places`.
WeightedGraph extended(const WeightedGraph& graph, const HallucinatedGraph& candidate, PlaceSet places);

Eigen::MatrixXd dense_laplacian(const WeightedGraph& graph);

}  // namespace lapis::planner::test
