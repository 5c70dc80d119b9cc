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

/// A radian of turning counts as so many metres of path: a view changes by both.
inline constexpr double kMetresPerRadian = 0.5;

/// Path from one pose to another: distance, and the angle between them times kMetresPerRadian [m].
double path_between(const geometry::Pose& a, const geometry::Pose& b);

struct GraphConfig {
  Criterion criterion = Criterion::kD;  ///< of the graph, and of its edges' weights
  Sparsifier sparsifier = Sparsifier::kNone;
  int max_edges = 10'000;  ///< what the sparsifier leaves of a larger graph
};

struct LoopClosure {
  int older = 0, newer = 0;  ///< nodes
  double weight = 0.0;
};

/// slam's pose graph as decisions need it: the part that hangs together with the newest key-frame. Node i is
/// keyframes[i]; the newest is the last. Made once per version of the graph.
struct AnalysedGraph {
  WeightedGraph graph;  ///< that is analysed, thinned out if it was large
  Criterion criterion;  ///< of its weights
  LaplacianFactor factor;
  std::vector<Keyframe> keyframes;  ///< by id
  std::vector<LoopClosure> loops;
  /// Shortest path along edges, also those that were thinned out, from the newest key-frame to each node [m].
  std::vector<double> path_from_newest_m;
  /// Path through all key-frames up to each, in the order of ids [m].
  std::vector<double> travelled_m;
  /// Weight of an odometry edge, times its length [m]: the median of what joins neighbouring key-frames, all paths
  /// through the graph together.
  double odometry_weight_metres = 0.0;
  /// Median of the loop closures' weights; without any, that of an odometry edge of half a metre.
  double loop_weight = 0.0;
  /// Variance of an axis of the position for each unit of effective resistance to the first key-frame [m^2]. Resistance
  /// knows no heading, whose error moves what is far away; so this is what makes the newest key-frame as unsure as slam
  /// says, but at least the median over all edges of their own.
  double position_variance_per_resistance = 0.0;

  /// Nothing for a key-frame outside of the part.
  std::optional<int> node_of(std::uint64_t keyframe) const;
};

/// Standard deviation of the newest key-frame's position, each axis, from the first one [m].
double position_sigma_m(const AnalysedGraph& graph);

/// @param keyframes by ascending id
/// @param newest_variance_m2 of an axis of the newest key-frame's position, from the first one, as slam says; 0: it
/// does not. The error says which edge has no weight or names a key-frame that is not there, or that there are fewer
/// than two connected key-frames.
std::variant<AnalysedGraph, GraphError> analyse_graph(std::span<const Keyframe> keyframes,
                                                      std::span<const KeyframeEdge> edges,
                                                      const GraphConfig& config = {}, double newest_variance_m2 = 0.0);

}  // namespace lapis::planner
