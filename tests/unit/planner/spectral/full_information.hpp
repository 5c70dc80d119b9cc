#pragma once

#include <vector>

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::planner::test {

/// Twice the logarithm of what a pose graph is worth: by its weighted Laplacian, and by the whole information matrix of
/// its poses, which the first one stands for [Zhang et al. 2024, eq. 20 to 23].
struct LogDeterminants {
  double laplacian = 0.0;  ///< ln det of the reduced Laplacian, an edge weighing det(information)^(1/d)
  double full = 0.0;       ///< ln det of the information of all poses but the first, over d = 6 (3 in the plane)
};

struct GraphComparison {
  int nodes = 0;
  /// With ever more key-frames: a tenth, two tenths... of the drive; for each key-frame but the first.
  std::vector<LogDeterminants> growth;
  /// What each loop adds to a graph without it; at most 100 of them, spread over the drive.
  std::vector<LogDeterminants> loops;
};

/// Of a graph with the poses of all its nodes, connected at every stage and without any of its loops. Throws
/// std::runtime_error when it is not.
GraphComparison compare_with_full_information(const slam::PoseGraphSnapshot& graph);

/// Spearman's correlation of the two over a list; NaN of less than two.
double rank_correlation(const std::vector<LogDeterminants>& values);

}  // namespace lapis::planner::test
