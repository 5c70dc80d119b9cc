#pragma once

#include <vector>

#include <Eigen/Core>

namespace lapis::planner {

/// Length of a tour, in the unit of `cost`.
double tour_length(const Eigen::MatrixXd& cost, const std::vector<int>& order);

/// A short path through all nodes, each once, that begins at node 0 and ends anywhere, or at the last node when
/// `ends_at_last`: cheapest insertion, then reversals of parts (2-opt) and moves of single nodes (Or-opt) until none
/// makes it shorter. Deterministic.
/// @param cost between nodes: square, symmetric, without negative elements, at least 2 x 2
std::vector<int> short_tour(const Eigen::MatrixXd& cost, bool ends_at_last);

}  // namespace lapis::planner
