#include "slam/core/graph/graph_correction.hpp"

#include "slam/core/graph/pose_graph_optimizer.hpp"

namespace lapis::slam {

GraphCorrection correct_graph(PoseGraphSnapshot graph) {
  GraphCorrection correction;
  for (const PoseGraphNode& node : graph.nodes) correction.T_map_before.push_back(node.T_map_camera);
  OptimizerOptions options;
  options.is_robust = true;
  correction.weights = optimize_pose_graph(options, graph).weights;
  for (const PoseGraphNode& node : graph.nodes) correction.T_map_camera.push_back(node.T_map_camera);
  correction.marginals = graph_marginals(graph, correction.weights);
  return correction;
}

}  // namespace lapis::slam
