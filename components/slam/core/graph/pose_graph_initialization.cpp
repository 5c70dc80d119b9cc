#include "slam/core/graph/pose_graph_initialization.hpp"

#include <algorithm>
#include <deque>
#include <set>

#include <Eigen/SVD>

#include "slam/core/graph/graduated_weights.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"
#include "slam/core/graph/pose_graph_topology.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

// What the two linear systems share.
struct Pattern {
  FreePairs free;
  std::vector<int> order;
};

constexpr double kSlightDamping = 1e-12;  // keeps the equations solvable where edges have no information

template <int kDim>
Eigen::Matrix<double, kDim, kDim> nearest_rotation(const Eigen::Matrix<double, kDim, kDim>& M) {
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  if constexpr (kDim == 2) {
    const Eigen::Vector2d axis(M(0, 0) + M(1, 1), M(1, 0) - M(0, 1));
    if (!(axis.norm() > 0.0)) return Matrix::Identity();
    return (Matrix() << axis.x(), -axis.y(), axis.y(), axis.x()).finished() / axis.norm();
  } else {
    const Eigen::JacobiSVD<Matrix> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign < 0.0 ? -1.0 : 1.0).asDiagonal() * svd.matrixV().transpose();
  }
}

// Solves rotation of `to` = rotation of `from` * that of the edge, for all edges, with arbitrary matrices for
// rotations. Their rows are independent, so that one row of all nodes is one column of the linear system.
template <int kDim>
void relax_rotations(const PoseGraphTopology& topology, const Pattern& pattern, PoseGraphSnapshot& graph) {
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  BlockCholesky equations(kDim, pattern.order, pattern.free.pairs);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(kDim * topology.free_count, kDim);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphTopology::Edge& ends = topology.edges[i];
    const double weight = graph.edges[i].information.template bottomRightCorner<3, 3>().trace();
    const Matrix R = graph.edges[i].T_from_to.linear().template topLeftCorner<kDim, kDim>();
    const auto rotation = [&](std::size_t node) -> Matrix {
      return graph.nodes[node].T_map_camera.linear().template topLeftCorner<kDim, kDim>();
    };
    const int a = topology.free[ends.from], b = topology.free[ends.to];
    if (a >= 0) equations.add_diagonal(a, Matrix(weight * Matrix::Identity()));
    if (b >= 0) equations.add_diagonal(b, Matrix(weight * Matrix::Identity()));
    if (a >= 0 && b >= 0) {
      equations.add_pair(static_cast<std::size_t>(pattern.free.of_edge[i]), Matrix(-weight * R));
    } else if (a >= 0) {
      right.middleRows<kDim>(kDim * a) += weight * R * rotation(ends.to).transpose();
    } else if (b >= 0) {
      right.middleRows<kDim>(kDim * b) += weight * R.transpose() * rotation(ends.from).transpose();
    }
  }
  if (!equations.factorize(kSlightDamping)) return;
  const Eigen::MatrixXd rows = equations.solve(right);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (topology.free[i] < 0) continue;
    const Matrix M = rows.middleRows<kDim>(kDim * topology.free[i]).transpose();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<kDim, kDim>() = nearest_rotation<kDim>(M);
    graph.nodes[i].T_map_camera.linear() = R;
  }
}

void relax_translations(const PoseGraphTopology& topology, const Pattern& pattern, PoseGraphSnapshot& graph) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  BlockCholesky equations(1, pattern.order, pattern.free.pairs);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(topology.free_count, 3);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphTopology::Edge& ends = topology.edges[i];
    const PoseGraphEdge& edge = graph.edges[i];
    const double weight = edge.information.topLeftCorner<3, 3>().trace();
    const Pose &from = graph.nodes[ends.from].T_map_camera, &to = graph.nodes[ends.to].T_map_camera;
    const Eigen::RowVector3d offset = (from.linear() * edge.T_from_to.translation()).transpose();
    const int a = topology.free[ends.from], b = topology.free[ends.to];
    if (a >= 0) {
      equations.add_diagonal(a, Scalar(weight));
      right.row(a) -= weight * offset;
      if (b < 0) right.row(a) += weight * to.translation().transpose();
    }
    if (b >= 0) {
      equations.add_diagonal(b, Scalar(weight));
      right.row(b) += weight * offset;
      if (a < 0) right.row(b) += weight * from.translation().transpose();
    }
    if (a >= 0 && b >= 0) equations.add_pair(static_cast<std::size_t>(pattern.free.of_edge[i]), Scalar(-weight));
  }
  if (!equations.factorize(kSlightDamping)) return;
  const Eigen::MatrixXd positions = equations.solve(right);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (topology.free[i] >= 0) graph.nodes[i].T_map_camera.translation() = positions.row(topology.free[i]).transpose();
  }
}

}  // namespace

std::size_t add_missing_nodes(PoseGraphSnapshot& graph) {
  const NodePlaces places(graph);
  std::set<std::uint64_t> missing;
  for (const PoseGraphEdge& edge : graph.edges) {
    for (const std::uint64_t id : {edge.from, edge.to}) {
      if (!places.find(id)) missing.insert(id);
    }
  }
  for (const std::uint64_t id : missing) graph.nodes.push_back({id, {}, Pose::Identity()});
  return missing.size();
}

void mark_loop_closures(PoseGraphSnapshot& graph) {
  std::set<std::uint64_t> ids;
  for (const PoseGraphNode& node : graph.nodes) ids.insert(node.id);
  for (const PoseGraphEdge& edge : graph.edges) ids.insert({edge.from, edge.to});
  for (PoseGraphEdge& edge : graph.edges) {
    const auto [first, last] = std::minmax(edge.from, edge.to);
    const bool is_step = ids.upper_bound(first) == ids.find(last);
    edge.type = is_step ? EdgeType::kOdometry : EdgeType::kLoopClosure;
  }
}

void initialize_by_spanning_tree(PoseGraphSnapshot& graph) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  const std::vector<std::vector<std::size_t>> edges_of = edges_by_node(topology);
  std::vector<bool> is_reached(graph.nodes.size(), false);
  std::deque<std::size_t> nodes, loops;  // nodes whose edges come next; loop closures at nodes that were reached
  const auto reach = [&](std::size_t node, const Pose& T_map_node) {
    is_reached[node] = true;
    graph.nodes[node].T_map_camera = T_map_node;
    nodes.push_back(node);
  };
  const auto follow = [&](std::size_t i) {
    const auto [from, to] = topology.edges[i];
    const Pose& T_from_to = graph.edges[i].T_from_to;
    if (!is_reached[to]) reach(to, graph.nodes[from].T_map_camera * T_from_to);
    if (!is_reached[from]) reach(from, graph.nodes[to].T_map_camera * T_from_to.inverse());
  };
  for (std::size_t node = 0; node < graph.nodes.size(); ++node) {
    if (topology.free[node] < 0) reach(node, graph.nodes[node].T_map_camera);
  }
  while (!nodes.empty() || !loops.empty()) {
    if (nodes.empty()) {
      follow(loops.front());
      loops.pop_front();
      continue;
    }
    const std::size_t node = nodes.front();
    nodes.pop_front();
    for (const std::size_t i : edges_of[node]) {
      if (graph.edges[i].type == EdgeType::kLoopClosure) {
        loops.push_back(i);
      } else {
        follow(i);
      }
    }
  }
}

void initialize_by_chordal_relaxation(PoseGraphSnapshot& graph) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  Pattern pattern{free_pairs(topology, std::vector(graph.edges.size(), 1.0)), {}};
  pattern.order = elimination_order(topology.free_count, pattern.free.pairs);
  if (graph.is_planar) {
    relax_rotations<2>(topology, pattern, graph);
  } else {
    relax_rotations<3>(topology, pattern, graph);
  }
  relax_translations(topology, pattern, graph);
}

void initialize_poses(PoseGraphSnapshot& graph) {
  PoseGraphSnapshot relaxed = graph;
  initialize_by_chordal_relaxation(relaxed);
  if (pose_graph_chi2(relaxed) < pose_graph_chi2(graph)) graph.nodes.swap(relaxed.nodes);
}

void initialize_poses_robustly(PoseGraphSnapshot& graph) {
  PoseGraphSnapshot relaxed = graph;
  initialize_by_chordal_relaxation(relaxed);
  initialize_by_spanning_tree(graph);
  const double gate = chi2_gate(graph.is_planar ? 3 : 6);
  if (pose_graph_chi2(relaxed, gate) < pose_graph_chi2(graph, gate)) graph.nodes.swap(relaxed.nodes);
}

}  // namespace lapis::slam
