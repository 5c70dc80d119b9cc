#include "slam/core/graph/graph_worker.hpp"

#include <utility>

#include "slam/core/graph/pose_graph_optimizer.hpp"

namespace lapis::slam {
namespace {

// How many of the newest key-frames get their covariance anew. A frame's reference is among them, unless a place seen
// long ago was recognised; the covariance from before, without the newest loops, is then still an upper bound
// (SlamGraph::apply sees to those that a removed loop has made too small).
constexpr std::size_t kNewest = 100;

// Optimal poses of the graph, how well they are known, and which edges are outliers.
GraphCorrection optimize(PoseGraphSnapshot graph) {
  GraphCorrection correction;
  for (const PoseGraphNode& node : graph.nodes) correction.T_map_before.push_back(node.T_map_camera);
  OptimizerOptions options;
  options.is_robust = true;
  correction.weights = optimize_pose_graph(options, graph).weights;
  std::vector<std::uint64_t> newest;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    correction.T_map_camera.push_back(graph.nodes[i].T_map_camera);
    if (i + kNewest >= graph.nodes.size()) newest.push_back(graph.nodes[i].id);
  }
  const auto known = node_covariances(graph, newest, correction.weights);
  correction.covariances.resize(graph.nodes.size() - known.size());
  correction.covariances.insert(correction.covariances.end(), known.begin(), known.end());
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
