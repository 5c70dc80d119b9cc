#include "slam/core/pose_graph_optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "slam/core/graduated_weights.hpp"
#include "slam/core/pose_graph_problem.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;

constexpr double kFirstDamping = 1e-6, kMostDamping = 1e12, kDampingFactor = 10.0;
// A round of graduated non-convexity only has to follow its weights.
constexpr int kRoundIterations = 3;

/// Levenberg and Marquardt's method; steps are undamped as long as they succeed.
template <class Space>
class Minimizer {
 public:
  Minimizer(const OptimizerOptions& options, const PoseGraphTopology& topology, const PoseGraphSnapshot& graph)
      : options_(options), problem_(topology, graph), poses_(problem_.poses_of(graph)) {}

  /// Returns true when a step promised or brought too little to go on.
  bool minimize(const std::vector<double>& weights, int max_iterations) {
    double chi2 = problem_.chi2(poses_, weights);
    bool is_linearized = false;
    for (int i = 0; i < max_iterations; ++i) {
      const double enough = options_.relative_decrease * chi2;
      if (!is_linearized) problem_.linearize(poses_, weights);
      is_linearized = true;
      ++iterations_;
      const auto step = problem_.step(damping_);
      if (step) {
        auto candidate = problem_.moved(poses_, *step);
        const double candidate_chi2 = problem_.chi2(candidate, weights);
        const bool is_last = problem_.predicted_decrease(*step) <= enough && damping_ <= kFirstDamping;
        if (candidate_chi2 < chi2) {
          const double decrease = chi2 - candidate_chi2;
          poses_.swap(candidate);
          chi2 = candidate_chi2;
          is_linearized = false;
          damping_ = damping_ > kFirstDamping ? damping_ / kDampingFactor : 0.0;
          if (is_last || (decrease <= enough && damping_ == 0.0)) return true;
          continue;
        }
        if (is_last) return true;
      }
      damping_ = std::max(damping_ * kDampingFactor, kFirstDamping);
      if (damping_ > kMostDamping) return true;
    }
    return false;
  }

  const PoseGraphProblem<Space>& problem() const { return problem_; }
  const typename PoseGraphProblem<Space>::Poses& poses() const { return poses_; }
  int iterations() const { return iterations_; }

 private:
  const OptimizerOptions& options_;
  PoseGraphProblem<Space> problem_;
  typename PoseGraphProblem<Space>::Poses poses_;
  double damping_ = 0.0;
  int iterations_ = 0;
};

template <class Space>
OptimizerReport optimize(const OptimizerOptions& options, PoseGraphSnapshot& graph) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  Minimizer<Space> minimizer(options, topology, graph);
  OptimizerReport report;
  report.weights.assign(graph.edges.size(), 1.0);
  report.initial_chi2 = minimizer.problem().chi2(minimizer.poses(), report.weights);
  report.has_converged = minimizer.minimize(report.weights, options.max_iterations);
  if (options.is_robust) {
    GraduatedWeights graduated(graph.edges, Space::kDof);
    while (graduated.update(minimizer.problem().edge_chi2(minimizer.poses()), report.weights)) {
      const int limit = graduated.is_final() ? options.max_iterations : kRoundIterations;
      report.has_converged = minimizer.minimize(report.weights, limit);
    }
  }
  report.final_chi2 = minimizer.problem().chi2(minimizer.poses(), report.weights);
  report.iterations = minimizer.iterations();
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (topology.free[i] >= 0) graph.nodes[i].T_map_camera = Space::to_pose(minimizer.poses()[i]);
  }
  return report;
}

}  // namespace

OptimizerReport optimize_pose_graph(const OptimizerOptions& options, PoseGraphSnapshot& graph) {
  return graph.is_planar ? optimize<PlanarPoses>(options, graph) : optimize<SpatialPoses>(options, graph);
}

double pose_graph_chi2(const PoseGraphSnapshot& graph) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  const auto sum = [](const std::vector<double>& parts) { return std::accumulate(parts.begin(), parts.end(), 0.0); };
  if (graph.is_planar) {
    const PoseGraphProblem<PlanarPoses> problem(topology, graph);
    return sum(problem.edge_chi2(problem.poses_of(graph)));
  }
  const PoseGraphProblem<SpatialPoses> problem(topology, graph);
  return sum(problem.edge_chi2(problem.poses_of(graph)));
}

std::vector<std::optional<Matrix6d>> node_covariances(const PoseGraphSnapshot& graph,
                                                      const std::vector<std::uint64_t>& ids,
                                                      const std::vector<double>& weights) {
  std::vector<std::optional<Matrix6d>> result(ids.size());
  if (graph.nodes.empty()) return result;
  const NodePlaces places(graph);
  const PoseGraphTopology topology = pose_graph_topology(graph);
  PoseGraphProblem<SpatialPoses> problem(topology, graph);
  problem.linearize(problem.poses_of(graph), weights.empty() ? std::vector(graph.edges.size(), 1.0) : weights);
  if (!problem.equations().factorize(0.0)) return result;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(6 * std::ssize(topology.order), 6 * std::ssize(ids));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = places.find(ids[i]);
    if (!place || topology.free[*place] < 0) continue;
    right.block<6, 6>(6 * topology.free[*place], 6 * static_cast<Eigen::Index>(i)).setIdentity();
  }
  const Eigen::MatrixXd solution = problem.equations().solve(right);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = places.find(ids[i]);
    if (!place || topology.component[*place] != 0) continue;
    if (topology.free[*place] < 0) {
      result[i] = Matrix6d::Zero();
      continue;
    }
    // From the axes of the map to those of the node.
    Matrix6d R = Matrix6d::Zero();
    R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = graph.nodes[*place].T_map_camera.linear();
    const Matrix6d in_map = solution.block<6, 6>(6 * topology.free[*place], 6 * static_cast<Eigen::Index>(i));
    const Matrix6d in_node = R.transpose() * in_map * R;
    result[i] = 0.5 * (in_node + in_node.transpose());
  }
  return result;
}

std::optional<Matrix6d> node_covariance(const PoseGraphSnapshot& graph, std::uint64_t id,
                                        const std::vector<double>& weights) {
  return node_covariances(graph, {id}, weights).front();
}

}  // namespace lapis::slam
