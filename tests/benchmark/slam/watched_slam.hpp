#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/benchmark/slam/pose_error.hpp"

namespace lapis::slam::benchmark {

/// What slam said of one frame, and how true it was.
struct WatchedFrame {
  double t_s = 0.0;
  TrackingState state = TrackingState::kInitializing;
  PoseSource source = PoseSource::kNone;
  bool is_keyframe = false;
  PoseError error;                                    ///< of the pose in the map as published; only with a source
  geometry::Pose truth = geometry::Pose::Identity();  ///< T_start_camera
  double sigma_m = 0.0, sigma_rad = 0.0;              ///< of the pose in the map, along the least known direction
  std::uint32_t matches = 0, inliers = 0;
  std::uint64_t reference = 0;
  int map = 0;          ///< number of maps that slam had given up before
  double cpu_ms = 0.0;  ///< of the calling thread
  std::string reason;
};

/// Whether vision or surfaces hold the pose.
bool is_held(const WatchedFrame& frame);
/// The source in a word; without one "sub-map", "lost", or "initializing".
const char* word_for(const WatchedFrame& frame);

/// What is left at the end, all optimisations applied.
struct WatchedMap {
  std::size_t keyframes = 0, loops = 0, removed = 0;
  std::size_t unconnected = 0;  ///< key-frames of sub-maps that were not joined
  SubMapSummary parts;
  std::size_t wrong_loops = 0;       ///< edges that is_wrong
  std::size_t far_keyframes = 0;     ///< more than 1 m from the truth, map frame
  double ate_m = 0.0;                ///< RMS of the key-frames' positions after alignment (SE(3)); NaN without any
  std::vector<std::string> remarks;  ///< a line for each wrong loop
};

/// RGB-D SLAM beside the truth, which the first frame with a pose brings into the map. A map that slam gives up is
/// followed by another one, as in the component.
class WatchedSlam {
 public:
  WatchedSlam(const SlamConfig& config, const geometry::Pose& T_base_camera);

  void add_odometry(time::Time stamp, const geometry::Pose& T_odom_base);
  /// `T_start_camera`: true, in any frame that stands still.
  const WatchedFrame& process(const RgbdFrame& frame, const geometry::Pose& T_start_camera);
  const std::vector<WatchedFrame>& frames() const { return frames_; }
  /// Waits for the optimisations under way.
  WatchedMap finish();

 private:
  SlamConfig config_;
  geometry::Pose T_base_camera_;
  std::unique_ptr<RgbdSlam> slam_;
  int map_ = 0;
  std::optional<geometry::Pose> T_map_start_;
  std::map<std::int64_t, geometry::Pose> truth_;  // T_map_camera of frames with a pose, by stamp
  std::vector<WatchedFrame> frames_;
};

/// A line for every stretch from `from_s` on in which the pose is held, by odometry, or lost: from when to when, error
/// at both ends, why it began.
void print_stretches(const std::vector<WatchedFrame>& frames, double from_s);
/// A line for every frame.
void print_frames(const std::vector<WatchedFrame>& frames);

}  // namespace lapis::slam::benchmark
