#pragma once

#include <cstddef>

#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/front_end/front_end.hpp"
#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {

/// What a key-frame changes.
struct Model {
  Map& map;
  SlamGraph& graph;
  MotionModel& motion;
};

/// Makes key-frames of frames: features, surface, landmarks, edges of the pose graph, and the local bundle adjustment.
class MapBuilder {
 public:
  /// @param saved_keyframes of a map that is resumed: their stamps are of another time, no odometry leads from them
  explicit MapBuilder(const SlamConfig& config, std::size_t saved_keyframes = 0)
      : config_(config), saved_keyframes_(saved_keyframes) {}

  /// The first key-frame.
  KeyframeId begin(const Model& model, const Frame& frame, const geometry::Pose& T_map_camera) const;
  /// A key-frame where the front end has found the frame.
  KeyframeId extend(const Model& model, const Frame& frame, const FrameOutcome& outcome);
  /// Motions of odometry between key-frames that were left out (OdometryConfig::max_disagreement).
  std::size_t slip_count() const { return slips_; }

 private:
  KeyframeId add_keyframe(Map& map, const Frame& frame, const geometry::Pose& T_map_camera) const;
  void add_landmarks(Map& map, KeyframeId id) const;
  PoseGraphEdge parent_edge(const FrameOutcome& outcome, KeyframeId id) const;
  void add_odometry_edge(const Model& model, KeyframeId from, KeyframeId to, const TrackOutcome& seen);

  SlamConfig config_;
  std::size_t saved_keyframes_;
  std::size_t slips_ = 0;
};

}  // namespace lapis::slam
