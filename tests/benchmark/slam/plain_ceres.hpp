#pragma once

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam::benchmark {

/// What to compare with: Ceres with automatic derivatives, g2o's residual, a quaternion manifold in space (x, y, angle
/// in the plane), SPARSE_NORMAL_CHOLESKY with SuiteSparse, one thread, from the graph's poses. The first node is fixed.
void optimize_with_plain_ceres(PoseGraphSnapshot& graph, int max_iterations);

}  // namespace lapis::slam::benchmark
