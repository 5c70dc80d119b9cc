#include "planner/core/spectral/candidate_gain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace lapis::planner {
namespace {

// Least squared pivot relative to the node's degree: below it, rounding errors have destroyed the node's connection.
constexpr double kLeastPivot = 1e-12;

double log_determinant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

// Adds the Laplacian of an edge.
void add_edge(Eigen::MatrixXd& laplacian, Eigen::Index a, Eigen::Index b, double weight) {
  laplacian(a, a) += weight;
  laplacian(b, b) += weight;
  laplacian(a, b) -= weight;
  laplacian(b, a) -= weight;
}

// Rows of the small matrices: first the new nodes, then the old nodes that edges touch.
class TouchedNodes {
 public:
  TouchedNodes(int first_new, const HallucinatedGraph& candidate)
      : first_new_(first_new), new_nodes_(candidate.node_count) {
    for (const HallucinatedEdge& hallucinated : candidate.edges) {
      for (const int node : {hallucinated.edge.a, hallucinated.edge.b}) {
        if (node < first_new) old_.push_back(node);
      }
    }
    std::sort(old_.begin(), old_.end());
    old_.erase(std::unique(old_.begin(), old_.end()), old_.end());
  }

  const std::vector<int>& old() const { return old_; }
  Eigen::Index size() const { return new_nodes_ + std::ssize(old_); }
  Eigen::Index row(int node) const {
    if (node >= first_new_) return node - first_new_;
    return new_nodes_ + (std::lower_bound(old_.begin(), old_.end(), node) - old_.begin());
  }

 private:
  int first_new_, new_nodes_;
  std::vector<int> old_;
};

std::optional<GraphError> candidate_error(int graph_nodes, const HallucinatedGraph& candidate) {
  for (const HallucinatedEdge& hallucinated : candidate.edges) {
    if (auto error = edge_error(graph_nodes + candidate.node_count, hallucinated.edge)) return error;
    if (hallucinated.place < HallucinatedEdge::kCertain || hallucinated.place >= kMaxPlaces) {
      return GraphError{"place " + std::to_string(hallucinated.place) + " of a loop edge is beyond 0.." +
                        std::to_string(kMaxPlaces - 1)};
    }
  }
  return std::nullopt;
}

}  // namespace

std::variant<CandidateGain, GraphError> CandidateGain::make(const LaplacianFactor& factor,
                                                            const HallucinatedGraph& candidate) {
  if (auto error = candidate_error(factor.node_count(), candidate)) return *error;
  const TouchedNodes touched(factor.node_count(), candidate);
  CandidateGain gain;
  gain.graph_nodes_ = factor.node_count();
  gain.new_nodes_ = candidate.node_count;
  gain.graph_log_trees_ = factor.log_trees();
  Eigen::MatrixXd certain = Eigen::MatrixXd::Zero(touched.size(), touched.size());
  for (const HallucinatedEdge& hallucinated : candidate.edges) {
    const WeightedEdge& edge = hallucinated.edge;
    const Eigen::Index a = touched.row(edge.a), b = touched.row(edge.b);
    if (hallucinated.place == HallucinatedEdge::kCertain)
      add_edge(certain, a, b, edge.weight);
    else
      gain.loops_.push_back({a, b, edge.weight, hallucinated.place});
  }
  if (!gain.add_certain(certain, factor.covariance(touched.old()))) {
    return GraphError{"new nodes are not connected to the graph by certain edges"};
  }
  return gain;
}

// Let C, B and D be the blocks of `certain` by new and old nodes, and G the covariance of the old nodes. F = -C^-1 B
// transfers displacements of the old nodes to the new ones, M = D + B' F is the information of the certain edges on the
// old nodes, and their covariance becomes (G^-1 + M)^-1 = (I + G M)^-1 G. Returns false when C is singular. Lazy
// products are faster for matrices this small.
bool CandidateGain::add_certain(const Eigen::MatrixXd& certain, const Eigen::MatrixXd& G) {
  const Eigen::Index k = new_nodes_, s = G.rows();
  new_block_ = certain.topLeftCorner(k, k);
  const Eigen::LLT<Eigen::MatrixXd> C(new_block_);
  if (C.info() != Eigen::Success) return false;
  const auto pivots = C.matrixLLT().diagonal().array().square();
  if ((pivots < kLeastPivot * new_block_.diagonal().array()).any()) return false;
  const Eigen::MatrixXd F = -C.solve(certain.topRightCorner(k, s));
  const Eigen::MatrixXd M = certain.bottomRightCorner(s, s) + certain.bottomLeftCorner(s, k).lazyProduct(F);
  const Eigen::PartialPivLU<Eigen::MatrixXd> update(Eigen::MatrixXd::Identity(s, s) + G.lazyProduct(M));
  certain_change_ = log_determinant(C) + update.matrixLU().diagonal().array().abs().log().sum();
  const Eigen::MatrixXd old_covariance = update.solve(G);
  covariance_.resize(k + s, k + s);
  covariance_.bottomRightCorner(s, s) = old_covariance;
  covariance_.topRightCorner(k, s) = F.lazyProduct(old_covariance);
  covariance_.bottomLeftCorner(s, k) = covariance_.topRightCorner(k, s).transpose();
  covariance_.topLeftCorner(k, k) =
      C.solve(Eigen::MatrixXd::Identity(k, k)) + covariance_.topRightCorner(k, s).lazyProduct(F.transpose());
  return true;
}

double CandidateGain::d_optimality(PlaceSet places) const {
  return planner::d_optimality(graph_nodes_ + new_nodes_, graph_log_trees_ + log_trees_change(places));
}

std::vector<CandidateGain::LoopEdge> CandidateGain::loops_to(PlaceSet places) const {
  std::vector<LoopEdge> chosen;
  for (const LoopEdge& loop : loops_) {
    if ((places & only_place(loop.place)) != 0) chosen.push_back(loop);
  }
  return chosen;
}

// I + W^1/2 R W^1/2, where R is the covariance of the differences across the loop edges.
Eigen::MatrixXd CandidateGain::loop_system(const std::vector<LoopEdge>& loops) const {
  const auto size = std::ssize(loops);
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const LoopEdge &e = loops[static_cast<std::size_t>(i)], &f = loops[static_cast<std::size_t>(j)];
      const double across =
          covariance_(e.a, f.a) - covariance_(e.a, f.b) - covariance_(e.b, f.a) + covariance_(e.b, f.b);
      system(i, j) += std::sqrt(e.weight * f.weight) * across;
    }
  }
  return system;  // only the lower triangle is set
}

double CandidateGain::loop_gain(PlaceSet places) const {
  return log_determinant(Eigen::LLT<Eigen::MatrixXd>(loop_system(loops_to(places))));
}

double CandidateGain::fixed_n_change(PlaceSet places) const {
  Eigen::MatrixXd new_block = new_block_;
  for (const LoopEdge& loop : loops_to(places)) {
    if (loop.a < new_nodes_) new_block(loop.a, loop.a) += loop.weight;
    if (loop.b < new_nodes_) new_block(loop.b, loop.b) += loop.weight;
    if (std::max(loop.a, loop.b) >= new_nodes_) continue;
    new_block(loop.a, loop.b) -= loop.weight;
    new_block(loop.b, loop.a) -= loop.weight;
  }
  return log_trees_change(places) - log_determinant(Eigen::LLT<Eigen::MatrixXd>(new_block));
}

double CandidateGain::variance(int new_node, PlaceSet places) const {
  const std::vector<LoopEdge> loops = loops_to(places);
  const Eigen::Index node = new_node - graph_nodes_;
  Eigen::VectorXd across(std::ssize(loops));
  for (Eigen::Index i = 0; i < across.size(); ++i) {
    const LoopEdge& loop = loops[static_cast<std::size_t>(i)];
    across[i] = std::sqrt(loop.weight) * (covariance_(node, loop.a) - covariance_(node, loop.b));
  }
  const Eigen::LLT<Eigen::MatrixXd> system(loop_system(loops));
  return covariance_(node, node) - system.matrixL().solve(across).squaredNorm();
}

}  // namespace lapis::planner
