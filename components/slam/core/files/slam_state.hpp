#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/map/keyframe_link.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/motion/wheel_calibration.hpp"

namespace lapis::slam {

/// Latest stamp and session (sessions are named by stamps) [ns]: in 2038, where the stamps of messages end.
inline constexpr std::int64_t kLastStamp_ns = 2'147'483'647'999'999'999;

/// A landmark without its observations, which the key-frames list.
struct LandmarkState {
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< [m]
  double finest_distance_m = 0.0;                   ///< as in Landmark [m]
};

/// Where the camera was and how it got there: what leads on from a saved map within the same run.
struct SavedMotion {
  time::Time stamp;                       ///< of the pose that was found last
  RelativeCamera camera;                  ///< that pose
  time::Time held_stamp;                  ///< of the newest pose by vision or surfaces
  std::vector<OdometryReading> odometry;  ///< since the newest key-frame, or longer
};

/// What RgbdSlam needs to resume a map, without what it can compute again.
struct SlamState {
  double scale_factor = 0.0;  ///< FeatureConfig::scale_factor to which the features' octaves refer
  std::uint64_t graph_version = 0;
  KeyframeId reference = 0;  ///< key-frame against which the camera was tracked last
  std::vector<Keyframe> keyframes;
  std::vector<LandmarkState> landmarks;  ///< by id; those that no feature shows are dead
  std::vector<PoseGraphEdge> edges;
  std::vector<KeyframeLink> links;
  std::vector<geometry::Matrix6d> covariances;  ///< of each key-frame's pose, as TrackingResult::map_covariance
  WheelCalibration wheels;                      ///< motions = 0: nothing was learnt
  std::optional<SavedMotion> motion;            ///< of the same run; nothing in a later one, or before the first pose
  std::vector<KeyframeId> parts;                ///< Keyframe::sub_map of each key-frame; empty: there are no sub-maps
};

/// Returns what is wrong with a state that did not come from RgbdSlam itself: ids that point nowhere, numbers that are
/// not finite or out of range, no key-frames. Returns nothing when the state is sound.
std::optional<std::string> find_fault(const SlamState& state);

/// Map of a sound state. The observations of a landmark are in the order of the key-frames.
Map restore_map(const SlamState& state);

/// True for cameras with the same image size whose focal lengths and centres differ by less than 1 % of the width: they
/// differ by a new calibration only.
bool is_same_camera(const geometry::PinholeCamera& a, const geometry::PinholeCamera& b);

}  // namespace lapis::slam
