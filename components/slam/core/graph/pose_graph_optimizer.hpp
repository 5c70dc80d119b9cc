#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

struct OptimizerOptions {
  int max_iterations = 100;         ///< linear systems solved; a robust run may take as many in each of its rounds
  double relative_decrease = 1e-6;  ///< of chi2; a step that promises no more is the last
  bool is_robust = false;           ///< expect wrong loop closures
};

struct OptimizerReport {
  double initial_chi2 = 0.0;  ///< sum of e' Omega e, all edges with weight 1
  double final_chi2 = 0.0;    ///< the same, each edge with its weight
  int iterations = 0;         ///< linear systems solved
  bool has_converged = false;
  std::vector<double> weights;  ///< of each edge, in [0, 1]; 1 where not robust
};

/// Moves the nodes to minimise the sum of e' Omega e over the edges, where e = (translation, 2 vec q) of
/// T_from_to^-1 * T_from^-1 * T_to, and q is its unit quaternion with w >= 0: g2o's chi2. (Planar graphs: translation,
/// angle.) The method is Levenberg-Marquardt on sparse normal equations. The first node of each connected part stays
/// where it is.
///
/// Robust: edges of type loop closure lose their weight where their chi2 would stay above the 99 % quantile (truncated
/// least squares by graduated non-convexity, Yang et al., RA-L 2020). Edges of wheel odometry keep a smaller weight
/// where the remaining loops contradict them. Other edges are trusted.
///
/// Throws std::invalid_argument when an edge names a node that the graph lacks, or the same node twice, or when two
/// nodes have the same id.
OptimizerReport optimize_pose_graph(const OptimizerOptions& options, PoseGraphSnapshot& graph);

/// Sum of e' Omega e over all edges, as above, where no edge counts for more than `most`.
double pose_graph_chi2(const PoseGraphSnapshot& graph, double most = std::numeric_limits<double>::infinity());

}  // namespace lapis::slam
