#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Marginal covariances of the poses of a graph relative to its first node, in the tangents of right perturbations
/// (translation, rotation) [m^2, rad^2], from the information of the whole graph, linearised at its poses.
struct GraphMarginals {
  /// Of each node; nothing for a node that no edges with weight connect to the first.
  std::vector<std::optional<geometry::Matrix6d>> covariances;
  /// Cross-covariance of each node (rows) with the newest one (columns); zero where either has no covariance.
  std::vector<geometry::Matrix6d> with_newest;
};

/// One factorisation serves all: the covariances are blocks of its selected inverse.
/// @param weights of each edge; empty: all 1
GraphMarginals graph_marginals(const PoseGraphSnapshot& graph, const std::vector<double>& weights = {});

}  // namespace lapis::slam
