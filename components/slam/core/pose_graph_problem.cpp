#include "slam/core/pose_graph_problem.hpp"

namespace lapis::slam {

template <class Space>
PoseGraphProblem<Space>::PoseGraphProblem(const PoseGraphTopology& topology, const PoseGraphSnapshot& graph)
    : topology_(topology), equations_(Space::kDof, topology.order, topology.pairs) {
  edges_.reserve(graph.edges.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    edges_.push_back({topology.edges[i], Space::from_pose(edge.T_from_to), Space::information(edge.information)});
  }
}

template <class Space>
typename PoseGraphProblem<Space>::Poses PoseGraphProblem<Space>::poses_of(const PoseGraphSnapshot& graph) {
  Poses poses;
  poses.reserve(graph.nodes.size());
  for (const PoseGraphNode& node : graph.nodes) poses.push_back(Space::from_pose(node.T_map_camera));
  return poses;
}

template <class Space>
std::vector<double> PoseGraphProblem<Space>::edge_chi2(const Poses& poses) const {
  std::vector<double> result;
  result.reserve(edges_.size());
  for (const Edge& edge : edges_) {
    const auto e = Space::residual(poses[edge.ends.from], poses[edge.ends.to], edge.measured);
    result.push_back(e.dot(edge.information * e));
  }
  return result;
}

template <class Space>
double PoseGraphProblem<Space>::chi2(const Poses& poses, const std::vector<double>& weights) const {
  const std::vector<double> parts = edge_chi2(poses);
  double sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) sum += weights[i] * parts[i];
  return sum;
}

template <class Space>
void PoseGraphProblem<Space>::linearize(const Poses& poses, const std::vector<double>& weights) {
  equations_.set_zero();
  gradient_.setZero(Space::kDof * static_cast<Eigen::Index>(topology_.order.size()));
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (weights[i] > 0.0) add(edges_[i], weights[i], poses);
  }
}

template <class Space>
void PoseGraphProblem<Space>::add(const Edge& edge, double weight, const Poses& poses) {
  using Matrix = typename Space::Matrix;
  const Pose &from = poses[edge.ends.from], &to = poses[edge.ends.to];
  Matrix J;
  const typename Space::Vector e = Space::residual(from, to, edge.measured, J);
  const Matrix JtW = weight * (J.transpose() * edge.information);
  const Matrix H = JtW * J;
  const typename Space::Vector g = JtW * e;
  const int a = topology_.free[edge.ends.from], b = topology_.free[edge.ends.to];
  if (b >= 0) {
    equations_.add_diagonal(b, H);
    gradient_.template segment<Space::kDof>(b * Space::kDof) += g;
  }
  if (a < 0) return;
  const Matrix M = Space::lever(from, to);
  const Matrix MtH = M.transpose() * H;
  equations_.add_diagonal(a, Matrix(MtH * M));
  gradient_.template segment<Space::kDof>(a * Space::kDof) -= M.transpose() * g;
  if (b >= 0) equations_.add_pair(static_cast<std::size_t>(edge.ends.pair), Matrix(-MtH));
}

template <class Space>
std::optional<Eigen::VectorXd> PoseGraphProblem<Space>::step(double damping) {
  if (!equations_.factorize(damping)) return std::nullopt;
  Eigen::VectorXd result = equations_.solve(-gradient_);
  if (!result.allFinite()) return std::nullopt;
  return result;
}

template <class Space>
typename PoseGraphProblem<Space>::Poses PoseGraphProblem<Space>::moved(const Poses& poses,
                                                                       const Eigen::VectorXd& step) const {
  Poses result = poses;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const int free = topology_.free[i];
    if (free >= 0) Space::move(result[i], step.segment<Space::kDof>(free * Space::kDof));
  }
  return result;
}

template <class Space>
double PoseGraphProblem<Space>::predicted_decrease(const Eigen::VectorXd& step) const {
  // Of the undamped step: g'x + x'Hx / 2 with Hx = -g; chi2 is twice that. A damped one falls short of it.
  return -gradient_.dot(step);
}

template class PoseGraphProblem<SpatialPoses>;
template class PoseGraphProblem<PlanarPoses>;

}  // namespace lapis::slam
