#pragma once

#include <vector>

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam::test {

/// Adds loop closures between random nodes until they are `share` of all loop closures: by turns the measurement of a
/// true loop closure (two places that look alike) and any pose within the extent of the graph, with the information of
/// a true one.
void add_wrong_loops(PoseGraphSnapshot& graph, double share, unsigned seed);

/// Positions of a graph's nodes in the order of ids, by chaining its edges: for truths that consist of edges [m].
std::vector<Eigen::Vector3d> chained_positions(PoseGraphSnapshot graph);

/// Root mean square distance of the nodes, in the order of ids, from their true positions after SE(3) alignment [m].
double trajectory_error_m(const PoseGraphSnapshot& graph, const std::vector<Eigen::Vector3d>& truth);

}  // namespace lapis::slam::test
