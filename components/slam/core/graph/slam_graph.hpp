#pragma once

#include <cstdint>
#include <vector>

#include "slam/core/graph/graph_correction.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/map/keyframe_link.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {

/// Where a sub-map is in another part of the map.
struct Junction {
  KeyframeId sub_map = 0, into = 0;  ///< names of the parts; `into` is older
  geometry::Pose T_into_sub_map = geometry::Pose::Identity();
  PoseGraphEdge place;               ///< between the parts, the one by which they are joined
  std::vector<PoseGraphEdge> loops;  ///< others, which agree with it
};

/// The part of a graph that the map consists of, without sub-maps and what connects them.
PoseGraphSnapshot without_sub_maps(PoseGraphSnapshot graph, const Map& map);

/// Edges between the key-frames of a map, and the covariances of their poses. Every key-frame but the first of a part
/// of the map has a parent, the older key-frame relative to which its pose was found, so each part is connected. The
/// covariance of a pose relative to another part is larger than any building.
class SlamGraph {
 public:
  SlamGraph() = default;
  /// Restores a saved graph; `covariances` are those of the key-frames' poses in the map.
  SlamGraph(std::vector<PoseGraphEdge> edges, std::vector<KeyframeLink> links,
            std::vector<geometry::Matrix6d> covariances);

  /// Adds the first key-frame of a part of the map; the pose of the very first is the gauge.
  void add_root();
  /// Moves a sub-map into another part of the map, and gives its first key-frame a parent there.
  void join(const Junction& junction, Map& map);
  /// Adds the next key-frame with the edge to its parent. `covariance` is that of its pose relative to the parent
  /// (right perturbation), by this edge and others beside it.
  void add_keyframe(const PoseGraphEdge& edge, const geometry::Matrix6d& covariance);
  void add_keyframe(const PoseGraphEdge& edge) { add_keyframe(edge, edge.information.inverse()); }
  void add_edge(const PoseGraphEdge& edge) { edges_.push_back(edge); }
  void add_link(const KeyframeLink& link) { links_.push_back(link); }

  /// Recomputes the edges of vision and surfaces at key-frames that bundle adjustment has moved, from the poses in the
  /// map.
  void follow(const Map& map, const std::vector<KeyframeId>& moved);
  /// Recomputes all edges and links but those of odometry from the poses in the map: it was made anew.
  void remeasure(const Map& map);
  /// Covariance of T_from_to by the edges to parents alone, as if no loop were closed: an upper bound.
  geometry::Matrix6d chain_covariance(const Map& map, KeyframeId from, KeyframeId to) const;
  /// Covariance of T_from_to: either by the edges to parents alone, or by all edges of the graph as of the last
  /// marginals, continued along the edges to parents from the newest key-frame in these; the one with the smaller sigma
  /// of position.
  geometry::Matrix6d relative_covariance(const Map& map, KeyframeId from, KeyframeId to) const;
  /// Moves the key-frames and landmarks of the map; key-frames younger than the correction follow their parents.
  /// Removes loop closures that turned out to be outliers.
  void apply(const GraphCorrection& correction, Map& map);
  /// Takes over the marginals of a snapshot of this graph, computed with its weights; the covariance of a younger
  /// key-frame is that of its parent compounded with that of the edge between them.
  void learn(const Map& map, const GraphMarginals& marginals);
  /// Number of key-frames, the oldest ones, in the last marginals.
  std::size_t analysed() const { return with_newest_.size(); }

  const std::vector<PoseGraphEdge>& edges() const { return edges_; }
  /// Weight of each edge after the last correction, in (0, 1]: odometry that loops contradict counts for less.
  std::vector<double> weights() const;
  const std::vector<geometry::Matrix6d>& covariances() const { return covariances_; }
  std::size_t count(EdgeType type) const;
  /// Whether odometry alone connects the key-frame: neither vision nor surfaces tie it to another one, and no
  /// optimisation has included a cycle of edges through it.
  bool is_drifting(KeyframeId id) const {
    const Parent& parent = parents_[static_cast<std::size_t>(id)];
    return parent.is_bridge && !parent.has_child;
  }
  /// Whether the path between two key-frames along parents contains an edge of odometry alone that nothing has
  /// corrected.
  bool are_apart(KeyframeId a, KeyframeId b) const;
  /// Number of loop closures that were accepted and later found to be outliers.
  std::size_t loops_removed() const { return loops_removed_; }
  const std::vector<KeyframeLink>& links() const { return links_; }
  /// Covariance of the key-frame's pose in the map.
  const geometry::Matrix6d& covariance(KeyframeId id) const { return covariances_[static_cast<std::size_t>(id)]; }
  /// Of all parts of the map.
  PoseGraphSnapshot snapshot(const Map& map, std::uint64_t version) const;

 private:
  struct Parent {
    KeyframeId id = 0;
    geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  // of T_parent_keyframe
    bool is_bridge = false;  // the edge is of odometry, and no optimisation has included a cycle through it
    bool has_child = false;  // a younger key-frame by vision or surfaces
  };
  void hold_circle(const PoseGraphEdge& edge);
  PoseGraphEdge parent_edge(const Map& map, const PoseGraphEdge& place, KeyframeId root) const;
  geometry::Matrix6d by_parent(const Map& map, KeyframeId id) const;
  geometry::Matrix6d covariance_to_newest_analysed(const Map& map, KeyframeId from) const;

  std::vector<PoseGraphEdge> edges_;
  std::vector<double> weights_;  // of the edges in the last correction
  std::vector<KeyframeLink> links_;
  std::vector<Parent> parents_;                  // of each key-frame; the first is its own
  std::vector<geometry::Matrix6d> covariances_;  // of each key-frame's pose in the map
  std::vector<geometry::Matrix6d> with_newest_;  // cross-covariances with the newest key-frame in the last marginals
  std::size_t loops_removed_ = 0;
};

}  // namespace lapis::slam
