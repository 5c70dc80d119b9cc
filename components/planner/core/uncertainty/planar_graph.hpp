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

/// slam's pose graph with three unknowns per key-frame: its errors along x and y of the map frame [m] and of its
/// heading about z [rad], because the robot moves on a floor. The edges have information on all six degrees of freedom;
/// the errors of the other three are held at zero. The first key-frame has no errors. The graph is made once per
/// version and then only read.
class PlanarGraph {
 public:
  /// The part of the graph that is connected to the newest key-frame; node i is keyframes()[i]. The error says that an
  /// edge has no weight, does not have the information of a pose, or names a key-frame that does not exist, that there
  /// are fewer than two connected key-frames, or that the matrix is singular up to rounding.
  /// @param keyframes sorted by id
  /// @param edges with 6x6 information in the tangent space (translation, rotation) of a right perturbation at `to`
  static std::variant<PlanarGraph, GraphError> make(std::span<const Keyframe> keyframes,
                                                    std::span<const KeyframeEdge> edges);

  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  /// Joint covariance of nodes, which may repeat: three rows and columns (x, y, heading) per node [m, rad].
  Eigen::MatrixXd covariance(std::span<const int> nodes) const;
  /// Covariance of each node by itself.
  std::vector<Eigen::Matrix3d> marginals() const;
  /// Covariance of all nodes with one: three rows per node, three columns.
  Eigen::MatrixX3d columns(int node) const;

 private:
  PlanarGraph(std::vector<Keyframe> keyframes, SparseCholesky factor)
      : keyframes_(std::move(keyframes)), factor_(std::move(factor)) {}

  std::vector<Keyframe> keyframes_;
  SparseCholesky factor_;  // three indices per node, without the first node
};

}  // namespace lapis::planner
