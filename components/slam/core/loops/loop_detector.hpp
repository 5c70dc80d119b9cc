#pragma once

#include <optional>
#include <vector>

#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/loops/place_index.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Key-frame `to` shows what the older key-frame `from` shows.
struct Revisit {
  KeyframeId from = 0;
  KeyframeId to = 0;
};

/// Whether a loop may differ so from what the graph says, with its covariance (right perturbation; translation,
/// rotation): 99.9 % of right loops do, if errors are up to three times as large as believed. That allowance falls from
/// 1 m on, to none at 3 m: rooms that are copies of each other are as far apart.
bool is_plausible(const geometry::Vector6d& error, const geometry::Matrix6d& covariance);

/// Recognises, at a new key-frame, places that were seen before. What the place index proposes, and what is near in the
/// map, is verified in 3-D; a loop counts when a second key-frame soon after says the same.
class LoopDetector {
 public:
  explicit LoopDetector(const SlamConfig& config) : config_(config) {}

  /// Remembers the key-frames of a saved map.
  void restore(const Map& map);
  /// The key-frames that are most similar to a frame, for relocalisation; best first.
  std::vector<KeyframeId> resembling(const Frame& frame) const;
  /// The key-frame has got its place in the map and the graph: looks for older ones that show the same, and remembers
  /// it. Returns the edges that close loops: none, or those of a pair of key-frames that agree.
  std::vector<PoseGraphEdge> add(const Map& map, const SlamGraph& graph, const Tracker& tracker, const Frame& frame,
                                 KeyframeId id);
  /// What was recognised and confirmed, in the order of time, whether or not it made an edge.
  const std::vector<Revisit>& revisits() const { return revisits_; }

 private:
  struct Candidate {
    KeyframeId keyframe = 0;
    std::optional<geometry::Pose> T_map_camera;  // where the frame is if the map is right; none: by appearance alone
  };
  std::vector<Candidate> candidates(const Map& map, const Frame& frame, KeyframeId id) const;
  std::optional<PoseGraphEdge> verify(const Map& map, const SlamGraph& graph, const Tracker& tracker,
                                      const Frame& frame, KeyframeId id) const;
  bool agrees(const Map& map, const PoseGraphEdge& earlier, const PoseGraphEdge& later) const;

  SlamConfig config_;
  PlaceIndex index_;
  std::optional<PoseGraphEdge> pending_;  // verified, not yet confirmed by a second one
  std::optional<KeyframeId> closed_;      // newest key-frame that made an edge
  std::vector<Revisit> revisits_;
};

}  // namespace lapis::slam
