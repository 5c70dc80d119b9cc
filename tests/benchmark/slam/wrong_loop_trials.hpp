#pragma once

#include <vector>

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam::benchmark {

/// Adds 10, 20 and 30 % wrong loop closures to a graph as slam has built it, `seeds` times each, optimises it as slam
/// does while it runs, and prints how much larger the trajectory's error becomes. Two starts: the poses of the map, as
/// when the wrong loops come last, and those along the chain of the other edges, as when all loops come at once.
/// `truth`: positions of the nodes, in the order of ids [m].
void print_wrong_loop_trials(const PoseGraphSnapshot& graph, const std::vector<Eigen::Vector3d>& truth, int seeds);

}  // namespace lapis::slam::benchmark
