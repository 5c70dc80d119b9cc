#pragma once

#include <variant>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// Optimality of a graph of two nodes or more, from the eigenvalues 0 = l_1 < l_2 <= ... <= l_n of its Laplacian, whose
/// weights have to be made by the same criterion: D (l_2 ... l_n)^(1/n), A the harmonic mean n / (1/l_2 + ... + 1/l_n),
/// T (l_2 + ... + l_n) / n, and E l_2 [Placed & Castellanos, "A General Relationship between Optimality Criteria and
/// Connectivity Indices for Active Graph-SLAM", 2022; Zhang et al. 2024, eq. 5 to 8].
/// T is a sum over the edges. The other criteria need a factorisation; A also needs a short column of its inverse per
/// node, and E some dozens of solves. The error is that of LaplacianFactor::make, or says that the graph has only one
/// node.
std::variant<double, GraphError> optimality(const WeightedGraph& graph, Criterion criterion);

}  // namespace lapis::planner
