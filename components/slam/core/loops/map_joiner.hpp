#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/tracking/surface_tracker.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Finds out where a sub-map is in another part of the map. New key-frames look for places of other parts, and each
/// place that is recognised says where the parts are to each other. One place is not believed, because rooms are copies
/// of each other, and nothing is known of the motion between the parts. What decides is how far many places agree:
/// - over a distance (SubMapConfig::evidence_m) along which the camera sees more than a room (SubMapConfig::room_m),
/// and
///   in several views without common landmarks;
/// - in significantly more key-frames than agree on another answer, or see through walls of the other part, if this one
///   is right (TrackerConfig::rival_sigmas).
class MapJoiner {
 public:
  explicit MapJoiner(const SlamConfig& config) : config_(config), surfaces_(config) {}

  /// Compares a new key-frame with the other parts of the map, if there are any.
  void look(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame, KeyframeId id);
  /// The junction for which there was enough evidence at the last look, if any.
  std::optional<Junction> junction();
  /// What spoke for the best answer when a junction was asked for last.
  struct Evidence {
    std::size_t keyframes = 0;           ///< that agree
    std::size_t others = 0;              ///< that agree on another answer, or contradict this one
    std::size_t views = 0;               ///< without common landmarks
    double span_m = 0.0, shown_m = 0.0;  ///< distances between the key-frames, and between what they show
  };
  const Evidence& evidence() const { return evidence_; }
  /// Whether the key-frames of a part span the distance without which it cannot be joined.
  bool is_large_enough(const Map& map, KeyframeId part) const;

 private:
  /// A new key-frame (edge.to) that shows a place of another part (edge.from), or would have to, but does not.
  struct Sighting {
    PoseGraphEdge edge;
    std::vector<LandmarkId> landmarks;  // seen again, ascending
    bool is_against = false;            // it sees through what is there
    // What follows from the map as it is now:
    KeyframeId older = 0, younger = 0;  // names of the parts
    geometry::Pose T_older_younger = geometry::Pose::Identity();
    Eigen::Vector3d p_younger = Eigen::Vector3d::Zero();      // where the key-frame of the younger part is in it
    Eigen::Vector3d shown_younger = Eigen::Vector3d::Zero();  // middle of the landmarks in it
  };
  /// Where two parts are to each other according to one sighting, and what else says so.
  struct Answer {
    const Sighting* by = nullptr;
    std::vector<const Sighting*> agreeing;  // in the order of time, `by` included
    std::size_t against = 0;                // number of those that contradict it
  };
  void follow(const Map& map);
  void add(const Map& map, Sighting sighting);
  void look_where_expected(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame,
                           KeyframeId id);
  std::optional<Sighting> contradiction(const Map& map, const Frame& frame, KeyframeId id,
                                        const LoopDetector::Candidate& expected) const;
  bool place(const Map& map, Sighting& sighting) const;
  bool agree(const Sighting& a, const Sighting& b) const;
  Answer answer_of(const Sighting& sighting) const;
  std::optional<Answer> best_answer() const;
  std::size_t rivals(const Answer& answer) const;
  std::vector<const Sighting*> views(const Answer& answer) const;
  bool is_enough(const Evidence& evidence) const;

  SlamConfig config_;
  SurfaceTracker surfaces_;
  std::vector<Sighting> sightings_;
  Evidence evidence_;
};

}  // namespace lapis::slam
