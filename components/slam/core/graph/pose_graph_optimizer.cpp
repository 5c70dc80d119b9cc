#include "slam/core/graph/pose_graph_optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "slam/core/graph/graduated_weights.hpp"
#include "slam/core/graph/pose_graph_problem.hpp"

namespace lapis::slam {
namespace {

constexpr double kLeastDamping = 1e-7, kFirstDamping = 1e-5, kLittleDamping = 3e-6, kMostDamping = 1e12;
// Iterations of least squares whose only purpose is to find what does not fit.
constexpr int kLookIterations = 10;
// Iterations of a round of graduated non-convexity, in which the poses only have to follow the weights.
constexpr int kRoundIterations = 2;
// Loop closures with more than this many times the median chi2 of those that do not fit wait until the others are
// decided.
constexpr double kSticksOut = 4.0;

/// Levenberg-Marquardt method; steps are undamped as long as they succeed.
template <class Space>
class Minimizer {
 public:
  Minimizer(const OptimizerOptions& options, const PoseGraphTopology& topology, const PoseGraphSnapshot& graph)
      : options_(options), problem_(topology, graph), poses_(PoseGraphProblem<Space>::poses_of(graph)) {}

  /// Returns true when a step with little damping promised too little to continue, or the damping has reached its
  /// limit.
  bool minimize(const std::vector<double>& weights, int max_iterations) {
    double chi2 = problem_.chi2(poses_, weights);
    bool is_linearized = false;
    if (damping_ > kMostDamping) damping_ = 0.0;
    raise_ = 2.0;
    for (int i = 0; i < max_iterations; ++i) {
      const double enough = options_.relative_decrease * chi2;
      if (!is_linearized) problem_.linearize(poses_, weights);
      is_linearized = true;
      ++iterations_;
      const auto step = problem_.step(damping_);
      const double promised = step ? problem_.predicted_decrease(*step) : 0.0;
      auto candidate = step ? problem_.moved(poses_, *step) : poses_;
      const double decrease = step ? chi2 - problem_.chi2(candidate, weights) : 0.0;
      const bool is_last = step && damping_ < kLittleDamping && promised <= enough;
      if (decrease > 0.0 && std::isfinite(decrease)) {
        poses_.swap(candidate);
        chi2 -= decrease;
        is_linearized = false;
        relax_damping(decrease / promised);
      } else {
        raise_damping();
      }
      if (is_last || damping_ > kMostDamping) return true;
    }
    return false;
  }

  std::vector<double> edge_chi2() const { return problem_.edge_chi2(poses_); }
  double chi2(const std::vector<double>& weights) const { return problem_.chi2(poses_, weights); }
  double contradiction(std::size_t edge, const std::vector<double>& weights) const {
    return problem_.contradiction(edge, poses_, weights);
  }
  const typename PoseGraphProblem<Space>::Poses& poses() const { return poses_; }
  int iterations() const { return iterations_; }

 private:
  // Nielsen (IMM-REP-1999-05): the damping follows the ratio of actual to predicted decrease.
  void relax_damping(double kept) {
    damping_ *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * kept - 1.0, 3));
    if (damping_ < kLeastDamping) damping_ = 0.0;
    raise_ = 2.0;
  }
  void raise_damping() {
    damping_ = std::max(damping_ * raise_, kFirstDamping);
    raise_ *= 2.0;
  }

  const OptimizerOptions& options_;
  PoseGraphProblem<Space> problem_;
  typename PoseGraphProblem<Space>::Poses poses_;
  double damping_ = 0.0, raise_ = 2.0;
  int iterations_ = 0;
};

/// Decides which loop closures count, and how much odometry counts that they contradict, because wheels slip. Loop
/// closures that stick out wait: with all wrong ones included from the beginning, the equations of a large graph would
/// be dense. Later, each of them that does not contradict the result of the others joins.
template <class Space>
class RobustMinimizer {
 public:
  RobustMinimizer(const OptimizerOptions& options, const PoseGraphSnapshot& graph, Minimizer<Space>& minimizer)
      : options_(options), minimizer_(minimizer), gate_(chi2_gate(Space::kDof)), weights_(graph.edges.size(), 1.0) {
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      if (graph.edges[i].type == EdgeType::kLoopClosure) waiting_.push_back(i);
      if (graph.edges[i].type == EdgeType::kWheelOdometry) wheels_.push_back(i);
    }
  }

  bool minimize() {
    for (const std::size_t i : waiting_) weights_[i] = 0.0;
    std::vector<std::size_t> active = take_moderate();
    bool has_converged = false;
    do {
      has_converged = graduate(active);
      std::erase_if(active, [&](std::size_t i) { return weights_[i] == 0.0; });
    } while (join_consistent(active));
    return release_slip() && has_converged;
  }
  const std::vector<double>& weights() const { return weights_; }

 private:
  // Loop closures that fit, or do not stick out.
  std::vector<std::size_t> take_moderate() {
    const std::vector<double> chi2 = minimizer_.edge_chi2();
    std::vector<double> misfits;
    for (const std::size_t i : waiting_) {
      if (chi2[i] > gate_) misfits.push_back(chi2[i]);
    }
    const auto middle = misfits.begin() + std::ssize(misfits) / 2;
    std::nth_element(misfits.begin(), middle, misfits.end());
    const double limit = misfits.empty() ? gate_ : kSticksOut * *middle;
    std::vector<std::size_t> result;
    std::copy_if(waiting_.begin(), waiting_.end(), std::back_inserter(result),
                 [&](std::size_t i) { return chi2[i] <= limit; });
    return result;
  }

  // Optimises with these loop closures, which all have full weight at first.
  bool graduate(const std::vector<std::size_t>& active) {
    for (const std::size_t i : active) weights_[i] = 1.0;
    GraduatedWeights graduated(active, gate_);
    bool has_converged = minimizer_.minimize(weights_, kLookIterations);
    while (graduated.update(minimizer_.edge_chi2(), weights_)) {
      has_converged = minimizer_.minimize(weights_, graduated.is_final() ? options_.max_iterations : kRoundIterations);
    }
    return has_converged || minimizer_.minimize(weights_, options_.max_iterations);
  }

  // Weights of odometry by dynamic covariance scaling (Agarwal, Tipaldi, Spinello, Stachniss and Burgard, ICRA 2013): a
  // motion that is far off stays, but no longer bends what is measured well. The weights are computed once, from the
  // residuals of least squares: of two motions that are equally far off, further rounds would believe one and blame the
  // other.
  bool release_slip() {
    const std::vector<double> chi2 = minimizer_.edge_chi2();
    for (const std::size_t i : wheels_) {
      const double scale = std::min(1.0, 2.0 * Space::kDof / (Space::kDof + chi2[i]));
      weights_[i] = scale * scale;
    }
    return wheels_.empty() || minimizer_.minimize(weights_, options_.max_iterations);
  }

  // Loop closures without weight that contradict nothing join, each only once. True when there were any.
  bool join_consistent(std::vector<std::size_t>& active) {
    const std::size_t before = active.size();
    std::erase_if(waiting_, [&](std::size_t i) {
      if (weights_[i] > 0.0 || minimizer_.contradiction(i, weights_) > gate_) return false;
      active.push_back(i);
      return true;
    });
    return active.size() > before;
  }

  const OptimizerOptions& options_;
  Minimizer<Space>& minimizer_;
  double gate_;
  std::vector<double> weights_;       // of every edge
  std::vector<std::size_t> waiting_;  // loop closures that may still join
  std::vector<std::size_t> wheels_;   // edges of wheel odometry
};

template <class Space>
OptimizerReport optimize(const OptimizerOptions& options, PoseGraphSnapshot& graph) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  Minimizer<Space> minimizer(options, topology, graph);
  OptimizerReport report;
  report.weights.assign(graph.edges.size(), 1.0);
  report.initial_chi2 = minimizer.chi2(report.weights);
  if (options.is_robust) {
    RobustMinimizer<Space> robust(options, graph, minimizer);
    report.has_converged = robust.minimize();
    report.weights = robust.weights();
  } else {
    report.has_converged = minimizer.minimize(report.weights, options.max_iterations);
  }
  report.final_chi2 = minimizer.chi2(report.weights);
  report.iterations = minimizer.iterations();
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (topology.free[i] >= 0) graph.nodes[i].T_map_camera = Space::to_pose(minimizer.poses()[i]);
  }
  return report;
}

template <class Space>
double total_chi2(const PoseGraphSnapshot& graph, double most) {
  const PoseGraphTopology topology = pose_graph_topology(graph);
  const PoseGraphProblem<Space> problem(topology, graph);
  double sum = 0.0;
  for (const double chi2 : problem.edge_chi2(PoseGraphProblem<Space>::poses_of(graph))) sum += std::min(chi2, most);
  return sum;
}

}  // namespace

OptimizerReport optimize_pose_graph(const OptimizerOptions& options, PoseGraphSnapshot& graph) {
  return graph.is_planar ? optimize<PlanarPoses>(options, graph) : optimize<SpatialPoses>(options, graph);
}

double pose_graph_chi2(const PoseGraphSnapshot& graph, double most) {
  return graph.is_planar ? total_chi2<PlanarPoses>(graph, most) : total_chi2<SpatialPoses>(graph, most);
}

}  // namespace lapis::slam
