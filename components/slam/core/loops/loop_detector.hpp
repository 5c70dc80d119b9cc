#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/loops/place_index.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Key-frame `to` shows the same place as the older key-frame `from`.
struct Revisit {
  KeyframeId from = 0;
  KeyframeId to = 0;
};

/// Whether the pose of a loop may differ by `error` from that of the graph, where `covariance` is that of the
/// difference (right perturbation; translation, rotation): 99.9 % of correct loops do, even if errors are up to three
/// times as large as believed. This factor falls from 3 at a distance of 1 m to 1 at 3 m, because rooms that are copies
/// of each other are that far apart.
bool is_plausible(const geometry::Vector6d& error, const geometry::Matrix6d& covariance);

/// Recognises, at a new key-frame, places that were seen before. It verifies in 3-D what the place index proposes and
/// what is near in the map; a loop counts when a second key-frame soon after finds it, too.
class LoopDetector {
 public:
  explicit LoopDetector(const SlamConfig& config) : config_(config) {}

  /// Remembers the key-frames of a saved map.
  void restore(const Map& map);
  /// Those of the wanted key-frames that are most similar to a frame; best first.
  std::vector<KeyframeId> resembling(const Frame& frame, const std::function<bool(KeyframeId)>& is_wanted) const;
  /// An older key-frame that may show the same place.
  struct Candidate {
    KeyframeId keyframe = 0;
    std::optional<geometry::Pose>
        T_map_camera;  ///< pose of the frame in its part of the map; none: it only looks alike
  };
  /// A candidate that shows the same place: the edge from it to the new key-frame, and the landmarks seen again.
  struct Sighting {
    PoseGraphEdge edge;
    std::vector<Match> matches;
  };
  /// Compares a frame, key-frame `id`, with a candidate; nothing when it does not determine the pose well. Whether the
  /// pose fits the map is not asked.
  std::optional<Sighting> compare(const Map& map, const Tracker& tracker, const Frame& frame, KeyframeId id,
                                  const Candidate& candidate) const;
  /// Call it when the key-frame is in the map and the graph: it looks for older key-frames that show the same place,
  /// and remembers the new one. Returns the edges that close loops: none, or those of a pair of key-frames that agree.
  std::vector<PoseGraphEdge> add(const Map& map, const SlamGraph& graph, const Tracker& tracker, const Frame& frame,
                                 KeyframeId id);
  /// Drops the loop that awaits its confirmation: the map was made anew.
  void drop_pending() { pending_.reset(); }
  /// Places that were recognised and confirmed, in the order of time, whether or not they made an edge.
  const std::vector<Revisit>& revisits() const { return revisits_; }

 private:
  std::vector<Candidate> candidates(const Map& map, const Frame& frame, KeyframeId id) const;
  std::optional<PoseGraphEdge> verify(const Map& map, const SlamGraph& graph, const Tracker& tracker,
                                      const Frame& frame, KeyframeId id) const;
  bool agrees(const Map& map, const PoseGraphEdge& earlier, const PoseGraphEdge& later) const;

  SlamConfig config_;
  PlaceIndex index_;
  std::optional<PoseGraphEdge> pending_;  // verified, not yet confirmed by a second one
  std::optional<KeyframeId> closed_;      // newest key-frame that made edges
  std::vector<Revisit> revisits_;
};

}  // namespace lapis::slam
