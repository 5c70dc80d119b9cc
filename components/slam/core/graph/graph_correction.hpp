#pragma once

#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// What an optimisation of the pose graph made of it.
struct GraphCorrection {
  std::vector<geometry::Pose> T_map_camera;  ///< of each key-frame that the optimisation knew
  std::vector<geometry::Pose> T_map_before;  ///< the same, when it began
  GraphMarginals marginals;                  ///< of the same
  std::vector<double> weights;               ///< of each edge that it knew, 0 = an outlier
};

/// Optimal poses of the graph, how well they are known, and which edges are outliers.
GraphCorrection correct_graph(PoseGraphSnapshot graph);

}  // namespace lapis::slam
