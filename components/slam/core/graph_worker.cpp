#include "slam/core/graph_worker.hpp"

#include <utility>

#include "slam/core/pose_graph_optimizer.hpp"

namespace lapis::slam {
namespace {

// Optimal poses of the graph, how well they are known, and which edges are outliers.
GraphCorrection optimize(PoseGraphSnapshot graph) {
  GraphCorrection correction;
  for (const PoseGraphNode& node : graph.nodes) correction.T_map_before.push_back(node.T_map_camera);
  OptimizerOptions options;
  options.is_robust = true;
  correction.weights = optimize_pose_graph(options, graph).weights;
  std::vector<std::uint64_t> ids;
  for (const PoseGraphNode& node : graph.nodes) {
    correction.T_map_camera.push_back(node.T_map_camera);
    ids.push_back(node.id);
  }
  correction.covariances = node_covariances(graph, ids, correction.weights);
  return correction;
}

}  // namespace

void GraphWorker::start(PoseGraphSnapshot graph, std::uint64_t due) {
  due_ = due;
  result_ = std::async(std::launch::async, optimize, std::move(graph));
}

std::optional<GraphCorrection> GraphWorker::take(std::uint64_t frame) {
  if (!is_busy() || frame < due_) return std::nullopt;
  return result_.get();
}

}  // namespace lapis::slam
