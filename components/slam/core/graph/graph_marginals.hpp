#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// How well the whole of a pose graph knows its poses, relative to its first node: covariances in the tangents of right
/// perturbations (translation, rotation) [m^2, rad^2], from the graph's information at its poses.
struct GraphMarginals {
  /// Of each node; nothing for one that no weighted edges join with the first.
  std::vector<std::optional<geometry::Matrix6d>> covariances;
  /// Of each node (rows) with the newest one (columns); zero where either has no covariance.
  std::vector<geometry::Matrix6d> with_newest;
};

/// One factorisation for all: the covariances are blocks of its selected inverse.
/// @param weights of each edge; none: all 1
GraphMarginals graph_marginals(const PoseGraphSnapshot& graph, const std::vector<double>& weights = {});

}  // namespace lapis::slam
