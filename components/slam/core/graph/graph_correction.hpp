#pragma once

#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Result of an optimisation of the pose graph.
struct GraphCorrection {
  std::vector<geometry::Pose> T_map_camera;  ///< of each key-frame in the optimised graph
  std::vector<geometry::Pose> T_map_before;  ///< the same before the optimisation
  GraphMarginals marginals;                  ///< of the same key-frames
  std::vector<double> weights;               ///< of each edge in the optimised graph; 0 = an outlier
};

/// Computes optimal poses of the graph and their covariances, and which edges are outliers.
GraphCorrection correct_graph(PoseGraphSnapshot graph);

}  // namespace lapis::slam
