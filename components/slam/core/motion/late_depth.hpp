#pragma once

#include <deque>

#include "common/geometry/se3.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam {

/// Depth, and when it was measured.
struct MeasuredDepth {
  time::Time stamp;
  geometry::PinholeCamera camera;
  geometry::DepthImage image;
};

/// Keeps depth of late until no colour image can be nearer to it, for depth that is not of colour's instant.
class LateDepth {
 public:
  /// Takes the depth of each frame, in the order of their stamps.
  void add(const RgbdFrame& frame);
  /// The depth to be used for colour of the newest frame: the nearest in time. What was measured before colour may be
  /// twice as far as what was measured after it: the motion between is then known from both ends, and where the
  /// velocity changes evenly, its error is still the smaller one, by half.
  /// @pre a frame has been added
  const MeasuredDepth& nearest() const;

 private:
  std::deque<MeasuredDepth> images_;
  time::Time color_stamp_;  // of the newest frame
};

/// Depth as a camera sees it in which the camera at the time of depth has the pose `T_color_depth`.
geometry::DepthImage seen_from(const geometry::Pose& T_color_depth, const MeasuredDepth& depth);

}  // namespace lapis::slam
