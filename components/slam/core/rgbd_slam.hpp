#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/calibration/depth_alignment.hpp"
#include "slam/core/config.hpp"
#include "slam/core/files/slam_state.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/front_end/tracking_result.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/wheel_calibration.hpp"

namespace lapis::slam {

/// Loops that the map has closed.
struct LoopSummary {
  std::size_t closures = 0;        ///< edges in the graph
  std::optional<time::Time> last;  ///< stamp of the key-frame that found the newest
  std::vector<Revisit> revisits;   ///< recognised and confirmed; not all of them made an edge
  std::size_t removed = 0;         ///< loops that were closed, and later found to be wrong
};

/// What became of the sub-maps.
struct SubMapSummary {
  std::size_t begun = 0, joined = 0;
  std::size_t given_up = 0;  ///< too small for a junction when the camera was lost again
};

/// RGB-D SLAM: features and surfaces aligned with a local map, local bundle adjustment, loop closure, pose graph.
/// Deterministic: the same frames give the same bits, although the graph is optimised in another thread.
class RgbdSlam {
 public:
  /// `T_map_first_camera`: pose given to the first key-frame; `T_base_camera`: pose of the camera on the robot, for
  /// wheel odometry.
  RgbdSlam(const SlamConfig& config, const geometry::Pose& T_map_first_camera,
           const geometry::Pose& T_base_camera = geometry::Pose::Identity());
  /// Resumes a saved map; `state` is sound (find_fault) and has the configuration's scale factor. With
  /// SlamState::motion, which has to be of this run, odometry leads on from the saved pose; else tracking is lost until
  /// the camera has been located in that map. Ids and graph version continue.
  RgbdSlam(const SlamConfig& config, const geometry::Pose& T_base_camera, SlamState state);
  ~RgbdSlam();

  /// Wheel odometry: the pose of base_link in a frame that may drift. Readings come in the order of their stamps; a
  /// reading is of use for a frame only if it comes before it. False when the reading cannot be used.
  bool add_odometry(time::Time stamp, const geometry::Pose& T_odom_base);
  /// Tracks one frame; frames come in the order of their stamps. A frame that cannot be used gives a result with a
  /// reason. Depth of another instant than colour is brought to the view of colour.
  TrackingResult process(const RgbdFrame& frame);

  /// Makes the map anew for `ratio` times the focal length that its key-frames have; ids and stamps stay, and the
  /// frames to come have the other camera. For young maps: false, and nothing changes, with too many key-frames or with
  /// loops, sub-maps, or key-frames that vision does not connect. Call it after a frame that became a key-frame.
  bool change_focal_length(double ratio);

  /// Keeps the depth images of the key-frames to come for correct_depth, or forgets those that are kept.
  void keep_depth(bool keeps);
  /// Makes the map anew for depth that was so far from where, and when, it was taken to be; ids, stamps and the camera
  /// stay. False, and nothing changes, in the cases of change_focal_length, and when the depth of a key-frame has not
  /// been kept. Afterwards none is kept.
  bool correct_depth(const DepthOffset& offset);

  /// T_odom_base at a stamp; nothing where there is no odometry.
  std::optional<geometry::Pose> odometry_at(time::Time stamp) const;
  /// Result for a frame that cannot be processed: it has a pose by dead reckoning, or none.
  TrackingResult skip(time::Time stamp, const std::string& reason) const;
  /// Waits for optimisations under way and applies them, so that the map is the final one.
  void settle();
  /// Of the map; a sub-map is not in it until it has been joined.
  PoseGraphSnapshot pose_graph() const;
  LoopSummary loops() const;
  /// Since the start of this process.
  SubMapSummary sub_maps() const;
  /// Whether another map has to begin: without odometry, the camera was lost when this one was still too small for any
  /// sub-map to be ever joined with it, and sees nothing of it any more. Never of a resumed map.
  bool is_given_up() const;
  /// What has to be saved to continue later. The large parts are shared with the map, not copied.
  SlamState state() const;
  /// Grows with every new key-frame and every change of a key-frame's pose.
  std::uint64_t graph_version() const;
  std::size_t keyframe_count() const;
  std::size_t landmark_count() const;
  const Map& map() const;
  /// Number of motions of odometry between key-frames that were left out as slip (OdometryConfig::max_disagreement).
  std::size_t slip_count() const;
  /// Calibration of the wheels; nothing as long as there is no odometry.
  std::optional<WheelCalibration> wheels() const;
  /// Number of recognised places that were not believed because odometry contradicted them.
  std::size_t places_doubted() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::slam
