#pragma once

#include <cstddef>

#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/front_end/front_end.hpp"
#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {

/// What a new key-frame changes.
struct Model {
  Map& map;
  SlamGraph& graph;
  MotionModel& motion;
};

/// Turns frames into key-frames: features, surface, landmarks, edges of the pose graph, and the local bundle
/// adjustment.
class MapBuilder {
 public:
  /// @param saved_keyframes number of those whose stamps are of an earlier run, so that no odometry leads from them
  explicit MapBuilder(const SlamConfig& config, std::size_t saved_keyframes = 0)
      : config_(config), saved_keyframes_(saved_keyframes) {}

  /// Adds the first key-frame of the map, or of a sub-map.
  KeyframeId begin(const Model& model, const Frame& frame, const geometry::Pose& T_map_camera) const;
  /// Adds a key-frame at the pose that the front end has found for the frame.
  KeyframeId extend(const Model& model, const Frame& frame, const FrameOutcome& outcome);
  /// Number of motions of odometry between key-frames that were left out as slip (OdometryConfig::max_disagreement).
  std::size_t slip_count() const { return slips_; }

 private:
  KeyframeId add_keyframe(Map& map, KeyframeId sub_map, const Frame& frame, const geometry::Pose& T_map_camera) const;
  void add_landmarks(Map& map, KeyframeId id) const;
  PoseGraphEdge parent_edge(const FrameOutcome& outcome, KeyframeId id) const;
  void add_odometry_edge(const Model& model, KeyframeId from, KeyframeId to, const TrackOutcome& seen);

  SlamConfig config_;
  std::size_t saved_keyframes_;
  std::size_t slips_ = 0;
};

}  // namespace lapis::slam
