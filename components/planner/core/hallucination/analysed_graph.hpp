#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "common/geometry/se3.hpp"
#include "planner/core/spectral/keyframe.hpp"
#include "planner/core/spectral/laplacian_factor.hpp"
#include "planner/core/spectral/sparsification.hpp"

namespace lapis::planner {

/// Length of path that counts as much as one radian of turning [m/rad]: a view changes by both.
inline constexpr double kMetresPerRadian = 0.5;

/// Length of the path from one pose to another: distance plus kMetresPerRadian times the angle between them [m].
double path_between(const geometry::Pose& a, const geometry::Pose& b);

struct GraphConfig {
  Criterion criterion = Criterion::kD;  ///< of the graph and of the weights of its edges
  Sparsifier sparsifier = Sparsifier::kNone;
  int max_edges = 10'000;  ///< size to which the sparsifier reduces a larger graph
};

struct LoopClosure {
  int older = 0, newer = 0;  ///< indices of nodes
  double weight = 0.0;
};

/// slam's pose graph in the form that decisions need: the part that is connected to the newest key-frame. Node i is
/// keyframes[i]; the newest key-frame is the last. Computed once per version of the graph.
struct AnalysedGraph {
  WeightedGraph graph;  ///< the analysed graph, sparsified if it was large
  Criterion criterion;  ///< of the graph's weights
  LaplacianFactor factor;
  std::vector<Keyframe> keyframes;  ///< sorted by id
  std::vector<LoopClosure> loops;
  /// Length of the shortest path along edges, those removed by the sparsifier included, from the newest key-frame to
  /// each node [m].
  std::vector<double> path_from_newest_m;
  /// Length of the path through all key-frames, in the order of their ids, up to each node [m].
  std::vector<double> travelled_m;
  /// Weight of an odometry edge times its length [m]: the median of effective conductance times distance over the
  /// newest pairs of neighbouring key-frames. The effective conductance includes all paths through the graph.
  double odometry_weight_metres = 0.0;
  /// Median of the loop closures' weights; without loop closures, the weight of an odometry edge of 0.5 m.
  double loop_weight = 0.0;
  /// Variance of an axis of the position per unit of effective resistance to the first key-frame [m^2]. The resistance
  /// does not model the heading, whose error displaces what is far away. The factor therefore reproduces the variance
  /// of the newest key-frame that slam publishes, but is at least the median of the edges' own ratios.
  double position_variance_per_resistance = 0.0;

  /// Node of a key-frame; empty when the key-frame is not in this part of the graph.
  std::optional<int> node_of(std::uint64_t keyframe) const;
};

/// Standard deviation of the newest key-frame's position relative to the first key-frame, per axis [m].
double position_sigma_m(const AnalysedGraph& graph);

/// Analyses the part of the graph that is connected to the newest key-frame. The error says that an edge has no weight
/// or names a key-frame that does not exist, or that there are fewer than two connected key-frames.
/// @param keyframes sorted by id
/// @param newest_variance_m2 variance per axis of the newest key-frame's position relative to the first, as slam
/// publishes it; 0 when slam does not publish it
std::variant<AnalysedGraph, GraphError> analyse_graph(std::span<const Keyframe> keyframes,
                                                      std::span<const KeyframeEdge> edges,
                                                      const GraphConfig& config = {}, double newest_variance_m2 = 0.0);

}  // namespace lapis::planner
