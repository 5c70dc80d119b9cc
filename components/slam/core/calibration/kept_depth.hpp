#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/calibration/depth_alignment.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// Keeps the depth images of key-frames, with how the camera moved about them, until it is known whether depth is of
/// colour's instant and of a camera where it is taken to be.
class KeptDepth {
 public:
  /// Takes each frame in the order of their stamps, with the pose that was found, if any, and the key-frame that it
  /// became, if any. Of key-frames beyond `kMost`, nothing is kept.
  void add(const Map& map, const RgbdFrame& frame, const std::optional<geometry::Pose>& T_map_camera,
           std::optional<KeyframeId> keyframe);
  /// Gives the key-frames of a map, all of which are kept, what their features and surfaces have by depth that was so
  /// far from where, and when, it was taken to be. Landmarks follow the key-frames that saw them first; poses stay.
  void correct(const SlamConfig& config, const DepthOffset& offset, Map& map) const;
  std::size_t keyframes() const { return kept_.size(); }

  static constexpr std::size_t kMost = 60;  // some tens of megabytes

 private:
  struct Kept {
    KeyframeId id = 0;
    time::Time stamp;
    geometry::DepthImage depth;
    std::optional<geometry::Vector6d> before, after;  // velocity to the key-frame, and from it [m/s, rad/s]
  };
  static geometry::DepthImage corrected(const Kept& kept, const geometry::PinholeCamera& camera,
                                        const DepthOffset& offset);

  std::vector<Kept> kept_;
  std::optional<std::pair<time::Time, geometry::Pose>> last_;  // T_map_camera
};

}  // namespace lapis::slam
