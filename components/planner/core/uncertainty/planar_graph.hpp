#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "planner/core/spectral/keyframe.hpp"
#include "planner/core/spectral/sparse_cholesky.hpp"
#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// slam's pose graph with three unknowns for each key-frame: its errors along x and y of the map frame [m] and of its
/// heading about z [rad], as a robot on a floor makes them. The information of the edges is that of all six, held in
/// the other three. The first key-frame has no errors. Made once per version of the graph and only read afterwards.
class PlanarGraph {
 public:
  /// The part that hangs together with the newest key-frame; node i is keyframes()[i].
  /// @param keyframes by ascending id
  /// @param edges information in the tangent (translation, rotation) of a right perturbation at `to`, 6x6
  /// The error says that an edge has no weight, has no information of a pose, or names a key-frame that is not there,
  /// that there are fewer than two connected key-frames, or that the matrix is singular to rounding.
  static std::variant<PlanarGraph, GraphError> make(std::span<const Keyframe> keyframes,
                                                    std::span<const KeyframeEdge> edges);

  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  /// Joint covariance of nodes, which may repeat: three rows and columns each.
  Eigen::MatrixXd covariance(std::span<const int> nodes) const;
  /// Covariance of each node alone.
  std::vector<Eigen::Matrix3d> marginals() const;

 private:
  PlanarGraph(std::vector<Keyframe> keyframes, SparseCholesky factor)
      : keyframes_(std::move(keyframes)), factor_(std::move(factor)) {}

  std::vector<Keyframe> keyframes_;
  SparseCholesky factor_;  // three indices for each node but the first
};

}  // namespace lapis::planner
