#include "slam/core/graph/pose_graph_problem.hpp"

#include <Eigen/Cholesky>

namespace lapis::slam {

namespace {

// The pattern is analysed again when more than this share of its edges has lost its weight: that costs less than a
// factorisation.
constexpr double kMostIdle = 0.02;

template <class Matrix>
Matrix inverse(const Matrix& symmetric) {
  // Edges may lack information in some direction: their uncertainty there is large, but bounded.
  const Matrix raised = symmetric + 1e-9 * (symmetric.trace() + 1e-9) * Matrix::Identity();
  return raised.llt().solve(Matrix::Identity());
}

}  // namespace

template <class Space>
PoseGraphProblem<Space>::PoseGraphProblem(const PoseGraphTopology& topology, const PoseGraphSnapshot& graph)
    : topology_(topology), edges_of_(edges_by_node(topology)) {
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
  if (!fits_pattern(weights)) analyze(weights);
  equations_->set_zero();
  gradient_.setZero(Space::kDof * topology_.free_count);
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (weights[i] > 0.0) add(i, weights[i], poses);
  }
}

template <class Space>
bool PoseGraphProblem<Space>::fits_pattern(const std::vector<double>& weights) const {
  if (equations_ == nullptr) return false;
  std::size_t idle = 0, count = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (weights[i] > 0.0 && !is_in_pattern_[i]) return false;
    count += is_in_pattern_[i] ? 1 : 0;
    idle += is_in_pattern_[i] && !(weights[i] > 0.0) ? 1 : 0;
  }
  return static_cast<double>(idle) <= kMostIdle * static_cast<double>(count);
}

template <class Space>
void PoseGraphProblem<Space>::analyze(const std::vector<double>& weights) {
  is_in_pattern_.clear();
  for (const double weight : weights) is_in_pattern_.push_back(weight > 0.0);
  pattern_ = free_pairs(topology_, weights);
  equations_ = std::make_unique<BlockCholesky>(Space::kDof, elimination_order(topology_.free_count, pattern_.pairs),
                                               pattern_.pairs);
}

template <class Space>
void PoseGraphProblem<Space>::add(std::size_t edge, double weight, const Poses& poses) {
  const auto& [ends, measured, information] = edges_[edge];
  using Matrix = typename Space::Matrix;
  const Pose &from = poses[ends.from], &to = poses[ends.to];
  Matrix J;
  const typename Space::Vector e = Space::residual(from, to, measured, J);
  const Matrix JtW = weight * (J.transpose() * information);
  const Matrix H = JtW * J;
  const typename Space::Vector g = JtW * e;
  const int a = topology_.free[ends.from], b = topology_.free[ends.to];
  if (b >= 0) {
    equations_->add_diagonal(b, H);
    gradient_.template segment<Space::kDof>(b * Space::kDof) += g;
  }
  if (a < 0) return;
  const Matrix M = Space::lever(from, to);
  const Matrix MtH = M.transpose() * H;
  equations_->add_diagonal(a, Matrix(MtH * M));
  gradient_.template segment<Space::kDof>(a * Space::kDof) -= M.transpose() * g;
  if (b >= 0) equations_->add_pair(static_cast<std::size_t>(pattern_.of_edge[edge]), Matrix(-MtH));
}

template <class Space>
std::optional<Eigen::VectorXd> PoseGraphProblem<Space>::step(double damping) {
  if (!equations_->factorize(damping)) return std::nullopt;
  Eigen::VectorXd result = equations_->solve(-gradient_);
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
Eigen::MatrixXd PoseGraphProblem<Space>::inverse_columns(int free_node) const {
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(Space::kDof * topology_.free_count, Space::kDof);
  right.template middleRows<Space::kDof>(Space::kDof * free_node).setIdentity();
  return equations_->solve(right);
}

// Edges of a shortest path of edges with weight, by breadth-first search.
template <class Space>
std::vector<std::size_t> PoseGraphProblem<Space>::path(std::size_t from, std::size_t to,
                                                       const std::vector<double>& weights) const {
  std::vector<std::optional<std::size_t>> reached_by(edges_of_.size());
  std::vector<std::size_t> reached = {from};
  const auto other_end = [&](std::size_t edge, std::size_t node) {
    return edges_[edge].ends.from == node ? edges_[edge].ends.to : edges_[edge].ends.from;
  };
  for (std::size_t next = 0; next < reached.size() && !reached_by[to]; ++next) {
    for (const std::size_t edge : edges_of_[reached[next]]) {
      const std::size_t node = other_end(edge, reached[next]);
      if (!(weights[edge] > 0.0) || node == from || reached_by[node]) continue;
      reached_by[node] = edge;
      reached.push_back(node);
    }
  }
  std::vector<std::size_t> result;
  for (std::size_t node = to; node != from && reached_by[node]; node = other_end(*reached_by[node], node)) {
    result.push_back(*reached_by[node]);
  }
  return result;
}

template <class Space>
double PoseGraphProblem<Space>::contradiction(std::size_t edge, const Poses& poses,
                                              const std::vector<double>& weights) const {
  using Matrix = typename Space::Matrix;
  const auto& [ends, measured, information] = edges_[edge];
  const std::vector<std::size_t> edges = path(ends.from, ends.to, weights);
  if (edges.empty()) return 0.0;
  Matrix J;
  // Covariance of the motion at the edge's end that the errors of the path cause, in the axes of the map.
  Matrix covariance = Matrix::Zero();
  for (const std::size_t i : edges) {
    const Pose& end = poses[edges_[i].ends.to];
    Space::residual(poses[edges_[i].ends.from], end, edges_[i].measured, J);
    const Matrix L = Space::lever(end, poses[ends.to]);
    covariance += L * inverse(Matrix(J.transpose() * edges_[i].information * J)) * L.transpose();
  }
  const typename Space::Vector e = Space::residual(poses[ends.from], poses[ends.to], measured, J);
  const Matrix of_residual = inverse(information) + J * covariance * J.transpose();
  return e.dot(of_residual.llt().solve(e));
}

template class PoseGraphProblem<SpatialPoses>;
template class PoseGraphProblem<PlanarPoses>;

}  // namespace lapis::slam
