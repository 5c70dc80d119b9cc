#include "tests/unit/slam/wrong_loops.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "slam/core/graph/pose_graph_initialization.hpp"

namespace lapis::slam::test {
namespace {

using Positions = Eigen::Matrix3Xd;

Positions positions_by_id(PoseGraphSnapshot graph) {
  std::sort(graph.nodes.begin(), graph.nodes.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  Positions result(3, std::ssize(graph.nodes));
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    result.col(i) = graph.nodes[static_cast<std::size_t>(i)].T_map_camera.translation();
  }
  return result;
}

geometry::Pose any_pose(double extent, std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-extent, extent);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d t(coordinate(random), coordinate(random), coordinate(random));
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return geometry::make_pose(t, Eigen::Quaterniond(w, x, y, z));
}

}  // namespace

void add_wrong_loops(PoseGraphSnapshot& graph, double share, unsigned seed) {
  std::vector<PoseGraphEdge> loops;
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.type == EdgeType::kLoopClosure) loops.push_back(edge);
  }
  const Positions positions = positions_by_id(graph);
  const double extent = (positions.rowwise().maxCoeff() - positions.rowwise().minCoeff()).maxCoeff() / 2.0;
  const auto count = static_cast<std::size_t>(std::lround(share / (1.0 - share) * static_cast<double>(loops.size())));
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < count;) {
    PoseGraphEdge edge = loops[random() % loops.size()];
    edge.from = graph.nodes[random() % graph.nodes.size()].id;
    edge.to = graph.nodes[random() % graph.nodes.size()].id;
    if (edge.from + 10 > edge.to && edge.to + 10 > edge.from) continue;
    if (i % 2 == 1) edge.T_from_to = any_pose(extent, random);
    graph.edges.push_back(edge);
    ++i;
  }
}

std::vector<Eigen::Vector3d> chained_positions(PoseGraphSnapshot graph) {
  add_missing_nodes(graph);
  initialize_by_spanning_tree(graph);
  const Positions positions = positions_by_id(std::move(graph));
  std::vector<Eigen::Vector3d> result;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) result.emplace_back(positions.col(i));
  return result;
}

double trajectory_error_m(const PoseGraphSnapshot& graph, const std::vector<Eigen::Vector3d>& truth) {
  const Positions estimate = positions_by_id(graph);
  Positions reference(3, std::ssize(truth));
  for (std::size_t i = 0; i < truth.size(); ++i) reference.col(static_cast<Eigen::Index>(i)) = truth[i];
  const Eigen::Affine3d T(Eigen::umeyama(estimate, reference, false));
  return std::sqrt((reference - T * estimate).colwise().squaredNorm().mean());
}

}  // namespace lapis::slam::test
