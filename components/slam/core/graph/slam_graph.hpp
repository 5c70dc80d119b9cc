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

/// Edges between the key-frames of a map, and what follows from them: how well each pose is known. Every key-frame but
/// the first has a parent, the older key-frame that its pose was found from; so the graph is connected.
class SlamGraph {
 public:
  SlamGraph() = default;
  /// From what was saved.
  SlamGraph(std::vector<PoseGraphEdge> edges, std::vector<KeyframeLink> links,
            std::vector<geometry::Matrix6d> covariances);

  /// The first key-frame: its pose is the gauge.
  void add_root();
  /// The next key-frame, with the edge to its parent, and how well it is known relative to that, by this edge and
  /// others beside it.
  void add_keyframe(const PoseGraphEdge& edge, const geometry::Matrix6d& covariance);
  void add_keyframe(const PoseGraphEdge& edge) { add_keyframe(edge, edge.information.inverse()); }
  void add_edge(const PoseGraphEdge& edge) { edges_.push_back(edge); }
  void add_link(const KeyframeLink& link) { links_.push_back(link); }

  /// Visual edges are what the local map says: those of key-frames that bundle adjustment has moved follow.
  void follow(const Map& map, const std::vector<KeyframeId>& moved);
  /// Covariance of T_from_to by the parents' edges alone, as if no loop were closed: an upper bound.
  geometry::Matrix6d chain_covariance(const Map& map, KeyframeId from, KeyframeId to) const;
  /// Covariance of T_from_to: of the parents' edges alone, or of all edges of the graph as the last marginals knew it
  /// and the parents' edges from the newest key-frame that they knew; whichever is surer of the position.
  geometry::Matrix6d relative_covariance(const Map& map, KeyframeId from, KeyframeId to) const;
  /// Moves key-frames and landmarks of the map; younger key-frames follow their parents. Edges that turned out to be
  /// outliers are removed.
  void apply(const GraphCorrection& correction, Map& map);
  /// Of a snapshot of this graph, with its weights; younger key-frames are known by what they hang on.
  void learn(const Map& map, const GraphMarginals& marginals);
  /// How many key-frames, the oldest ones, the last marginals knew.
  std::size_t analysed() const { return with_newest_.size(); }

  const std::vector<PoseGraphEdge>& edges() const { return edges_; }
  /// Of the edges, by the last correction, in (0, 1]: odometry that loops contradict counts for less.
  std::vector<double> weights() const;
  const std::vector<geometry::Matrix6d>& covariances() const { return covariances_; }
  std::size_t count(EdgeType type) const;
  /// Whether the key-frame hangs on odometry alone: no vision or surface ties it to another one, and no optimisation
  /// has known a circle of edges that it lies on.
  bool is_drifting(KeyframeId id) const {
    const Parent& parent = parents_[static_cast<std::size_t>(id)];
    return parent.is_bridge && !parent.has_child;
  }
  /// Whether on the path of edges between two key-frames there is one of odometry alone that nothing has corrected.
  bool are_apart(KeyframeId a, KeyframeId b) const;
  /// Loop closures that were accepted, and found to be outliers later.
  std::size_t loops_removed() const { return loops_removed_; }
  const std::vector<KeyframeLink>& links() const { return links_; }
  /// Of the key-frame's pose in the map.
  const geometry::Matrix6d& covariance(KeyframeId id) const { return covariances_[static_cast<std::size_t>(id)]; }
  PoseGraphSnapshot snapshot(const Map& map, std::uint64_t version) const;

 private:
  struct Parent {
    KeyframeId id = 0;
    geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  // of T_parent_keyframe
    bool is_bridge = false;  // the edge is of odometry, and no optimisation has known a circle that it lies on
    bool has_child = false;  // by vision or surfaces
  };
  void hold_circle(const PoseGraphEdge& edge);
  geometry::Matrix6d covariance_to_newest_analysed(const Map& map, KeyframeId from) const;

  std::vector<PoseGraphEdge> edges_;
  std::vector<double> weights_;  // of the edges that the last correction knew
  std::vector<KeyframeLink> links_;
  std::vector<Parent> parents_;                  // of each key-frame; the first is its own
  std::vector<geometry::Matrix6d> covariances_;  // of each key-frame's pose in the map
  std::vector<geometry::Matrix6d> with_newest_;  // of each key-frame with the newest one that marginals knew
  std::size_t loops_removed_ = 0;
};

}  // namespace lapis::slam
