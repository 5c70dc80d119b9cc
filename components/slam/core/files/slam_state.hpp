#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/map/keyframe_link.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/wheel_calibration.hpp"

namespace lapis::slam {

/// Stamps, and sessions, which are named by stamps, are not negative and end where those of messages do, in 2038.
inline constexpr std::int64_t kLastStamp_ns = 2'147'483'647'999'999'999;

/// A landmark but for the features that show it: key-frames list those.
struct LandmarkState {
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< [m]
  double finest_distance_m = 0.0;                   ///< as Landmark's
};

/// All that RgbdSlam has to know to resume a map, and nothing that it can work out again.
struct SlamState {
  double scale_factor = 0.0;  ///< FeatureConfig::scale_factor that the features' octaves count in
  std::uint64_t graph_version = 0;
  KeyframeId reference = 0;  ///< key-frame that the camera was tracked by last
  std::vector<Keyframe> keyframes;
  std::vector<LandmarkState> landmarks;  ///< by id; those that no feature shows are dead
  std::vector<PoseGraphEdge> edges;
  std::vector<KeyframeLink> links;
  std::vector<geometry::Matrix6d> covariances;  ///< of each key-frame's pose in the map, as TrackingResult's
  WheelCalibration wheels;                      ///< of no motions: nothing was learnt
};

/// What is wrong with a state that did not come from RgbdSlam itself: ids that point nowhere, numbers that are not
/// finite or out of range, no key-frames. Nothing when it is sound.
std::optional<std::string> find_fault(const SlamState& state);

/// The map of a sound state. Observations of a landmark come in the order of the key-frames.
Map restore_map(const SlamState& state);

/// True for cameras of the same image size whose focal lengths and centres differ by less than 1 % of the width: a new
/// calibration, not another camera.
bool is_same_camera(const geometry::PinholeCamera& a, const geometry::PinholeCamera& b);

}  // namespace lapis::slam
