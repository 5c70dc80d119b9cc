#include "tests/unit/planner/spectral/full_information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include <Eigen/SparseCholesky>

#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner::test {
namespace {

constexpr std::size_t kMostLoops = 100;
constexpr int kStages = 10;

/// The edges among the first key-frames, by the places of their nodes.
class Comparer {
 public:
  explicit Comparer(const slam::PoseGraphSnapshot& graph) : graph_(graph), free_{0, 1, 2, 3, 4, 5} {
    if (graph.is_planar) free_ = {0, 1, 5};
    for (const slam::PoseGraphNode& node : graph.nodes) place_.emplace(node.id, 0);
    int count = 0;
    for (auto& [id, place] : place_) place = count++;
    T_map_.resize(place_.size());
    for (const slam::PoseGraphNode& node : graph.nodes) T_map_[index(place_.at(node.id))] = node.T_map_camera;
    for (const slam::PoseGraphEdge& edge : graph.edges) {
      if (!place_.contains(edge.from) || !place_.contains(edge.to))
        throw std::runtime_error("an edge without its node");
    }
  }

  int nodes() const { return static_cast<int>(place_.size()); }
  /// Edges whose nodes are also joined by the drive.
  std::vector<std::size_t> loops() const {
    std::vector<std::size_t> loops;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      if (std::abs(from(i) - to(i)) > 1) loops.push_back(i);
    }
    return loops;
  }

  /// Of the first `nodes`, without one of the edges.
  LogDeterminants of(int nodes, std::size_t without) const {
    const auto d = std::ssize(free_);
    std::vector<WeightedEdge> weighted;
    std::vector<Eigen::Triplet<double>> elements;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      if (i == without || std::max(from(i), to(i)) >= nodes) continue;
      const Eigen::MatrixXd information = graph_.edges[i].information(free_, free_);
      const auto weight = edge_weight(information, Criterion::kD);
      if (!weight) throw std::runtime_error("the information of an edge is not positive definite");
      weighted.push_back({from(i), to(i), *weight});
      add(i, information, elements);
    }
    Eigen::SparseMatrix<double> H(d * (nodes - 1), d * (nodes - 1));
    H.setFromTriplets(elements.begin(), elements.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(H);
    if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0.0).any())
      throw std::runtime_error("the information of the poses is singular");
    return {make_factor(make_graph(nodes, std::move(weighted))).log_trees(),
            factor.vectorD().array().log().sum() / static_cast<double>(d)};
  }

 private:
  int from(std::size_t edge) const { return place_.at(graph_.edges[edge].from); }
  int to(std::size_t edge) const { return place_.at(graph_.edges[edge].to); }

  /// The error of an edge moves with xi_to - Ad(T_to_from) xi_from, each in the frame of its node.
  void add(std::size_t edge, const Eigen::MatrixXd& information, std::vector<Eigen::Triplet<double>>& elements) const {
    const geometry::Matrix6d adjoint = geometry::adjoint(T_map_[index(to(edge))].inverse() * T_map_[index(from(edge))]);
    const Eigen::MatrixXd A = -adjoint(free_, free_);
    add_block(from(edge), from(edge), A.transpose() * information * A, elements);
    add_block(from(edge), to(edge), A.transpose() * information, elements);
    add_block(to(edge), from(edge), information * A, elements);
    add_block(to(edge), to(edge), information, elements);
  }

  /// The first node is held.
  void add_block(int row, int column, const Eigen::MatrixXd& block,
                 std::vector<Eigen::Triplet<double>>& elements) const {
    if (row == 0 || column == 0) return;
    const int d = static_cast<int>(block.rows());
    for (int i = 0; i < d; ++i) {
      for (int j = 0; j < d; ++j) elements.emplace_back(d * (row - 1) + i, d * (column - 1) + j, block(i, j));
    }
  }

  const slam::PoseGraphSnapshot& graph_;
  std::vector<int> free_;
  std::map<std::uint64_t, int> place_;
  std::vector<geometry::Pose> T_map_;
};

/// Place of each value in the sorted list; equal ones share the mean of theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<double> result;
  for (const double value : values) {
    const auto less = std::count_if(values.begin(), values.end(), [&](double other) { return other < value; });
    const auto equal = std::count(values.begin(), values.end(), value);
    result.push_back(static_cast<double>(less) + 0.5 * static_cast<double>(equal - 1));
  }
  return result;
}

}  // namespace

GraphComparison compare_with_full_information(const slam::PoseGraphSnapshot& graph) {
  const Comparer comparer(graph);
  const std::size_t none = graph.edges.size();
  GraphComparison comparison;
  comparison.nodes = comparer.nodes();
  for (int stage = 1; stage <= kStages; ++stage) {
    const int nodes = std::max(2, comparer.nodes() * stage / kStages);
    const LogDeterminants all = comparer.of(nodes, none);
    comparison.growth.push_back({all.laplacian / (nodes - 1), all.full / (nodes - 1)});
  }
  const LogDeterminants all = comparer.of(comparer.nodes(), none);
  const std::vector<std::size_t> loops = comparer.loops();
  const std::size_t count = std::min(kMostLoops, loops.size());
  for (std::size_t k = 0; k < count; ++k) {
    const LogDeterminants without = comparer.of(comparer.nodes(), loops[k * loops.size() / count]);
    comparison.loops.push_back({all.laplacian - without.laplacian, all.full - without.full});
  }
  return comparison;
}

double rank_correlation(const std::vector<LogDeterminants>& values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> by_laplacian, by_full;
  for (const LogDeterminants& value : values) {
    by_laplacian.push_back(value.laplacian);
    by_full.push_back(value.full);
  }
  const std::vector<double> x = ranks(by_laplacian), y = ranks(by_full);
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::ArrayXd a = Eigen::Map<const Eigen::ArrayXd>(x.data(), n), b = Eigen::Map<const Eigen::ArrayXd>(y.data(), n);
  a -= a.mean();
  b -= b.mean();
  return (a * b).sum() / std::sqrt((a * a).sum() * (b * b).sum());
}

}  // namespace lapis::planner::test
