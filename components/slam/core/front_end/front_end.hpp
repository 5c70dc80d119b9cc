#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/front_end/tracking_result.hpp"
#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/loops/relocalizer.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/surface_tracker.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// What a frame is compared with.
struct Known {
  const Map& map;
  const SlamGraph& graph;
  const LoopDetector& places;
  const MotionModel& motion;
};

/// Result of the front end for one frame.
struct FrameOutcome {
  TrackingResult result;             ///< valid unless the frame becomes a key-frame; without the graph's version
  std::optional<TrackOutcome> seen;  ///< by vision or surfaces; none if odometry alone gives the pose, or nothing does
  bool wants_keyframe = false;
  bool ends_drift = false;   ///< a key-frame here closes a cycle, a part of which odometry alone connects
  bool begins_part = false;  ///< the key-frame is the first one of the map, or of a sub-map
};

/// Finds the pose of each frame by the best source that has one (vision, surfaces, odometry), and decides which frames
/// become key-frames. It changes nothing but its own memory of earlier frames.
class FrontEnd {
 public:
  explicit FrontEnd(const SlamConfig& config)
      : config_(config), tracker_(config), relocalizer_(config), surfaces_(config) {}

  /// Whether a map can begin with this frame; if not, the result has the reason.
  FrameOutcome begin(const Known& known, const Frame& frame);
  /// @pre the map is not empty
  FrameOutcome locate(const Known& known, const Frame& frame);
  /// T_map_camera of a frame near the pose that motion predicts, if it is found there: a first guess, nothing more.
  std::optional<geometry::Pose> guess(const Known& known, const Frame& frame) const;
  /// Result for a frame that cannot be used: it has a pose by dead reckoning, or none.
  TrackingResult without_vision(const Known& known, time::Time stamp, const std::string& reason) const;

  /// The frame has become this key-frame, which is the reference of the next frames.
  void enter_keyframe(const Map& map, KeyframeId id);
  /// The sub-map in which the camera was is given up: it is lost in the map again.
  void give_up(const Map& map);
  /// The map has changed.
  void renew(const Map& map) { tracker_.set_reference(map, reference_); }
  /// The map is a saved one. Unless it is of this run and odometry `leads_on` from the newest pose by vision or
  /// surfaces, at `held_stamp`, there is no pose until the camera has been located in it.
  void resume(const Map& map, KeyframeId reference, std::optional<time::Time> held_stamp, bool leads_on);

  KeyframeId reference() const { return reference_; }
  /// Stamp of the newest pose by vision or surfaces.
  std::optional<time::Time> held_stamp() const { return held_stamp_; }
  /// Compares frames with any key-frame.
  const Tracker& tracker() const { return tracker_; }
  /// Part of the map in which the camera is, or was.
  KeyframeId sub_map(const Map& map) const { return map.keyframe(reference_).sub_map; }
  /// Number of recognised places that were not believed because odometry contradicted them.
  std::size_t places_doubted() const { return relocalizer_.doubted(); }

 private:
  static constexpr double kUnknownSurprise_px = 1e6;

  TrackOutcome find_pose(const Known& known, const Frame& frame);
  double search_radius_px() const;
  FrameOutcome hold(const Known& known, const Frame& frame, TrackOutcome seen, PoseSource source, bool wants_keyframe);
  FrameOutcome continue_without_features(const Known& known, const Frame& frame, const std::string& reason);
  int features_to_begin(bool has_odometry) const;
  bool is_somewhere_new(const Known& known, const Frame& frame);
  FrameOutcome continue_blind(const Known& known, const Frame& frame, const std::string& reason, bool is_new_view);

  TrackingResult result_of(const Known& known, const Frame& frame, const TrackOutcome& seen) const;
  bool set_drift(const Known& known, time::Time stamp, TrackingResult& result) const;
  void count_contradictions(const TrackOutcome& aligned, bool is_unknown);
  bool is_contradicted() const;
  bool should_be_known(const Map& map, const RelativeCamera& camera) const;
  bool has_moved(const geometry::Pose& T_reference_camera) const;
  bool shows_surfaces(const Frame& frame) const;
  bool needs_keyframe_at(const Map& map, const TrackOutcome& seen) const;

  SlamConfig config_;
  Tracker tracker_;
  Relocalizer relocalizer_;
  SurfaceTracker surfaces_;
  KeyframeId reference_ = 0;
  int frames_since_keyframe_ = 0;
  int blind_frames_ = 0;                      // in a row, with enough features but no pose by vision
  int unknown_frames_ = 0;                    // in a row, without odometry, that show enough but no place of the map
  int contradictions_ = 0;                    // frames in a row that contradict odometry
  int fits_ = 0;                              // frames in a row whose surfaces fit
  std::optional<time::Time> held_stamp_;      // of the newest pose by vision or surfaces
  double surprise_px_ = kUnknownSurprise_px;  // how far features were from where motion predicted them, in late frames
  bool awaits_confirmation_ = false;          // a place was recognised in the newest frame, but is not believed yet
  bool is_placed_ = true;                     // false in a resumed map until the camera has been located in it
};

}  // namespace lapis::slam
