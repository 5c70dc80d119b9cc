#pragma once

#include "common/geometry/pinhole_camera.hpp"
#include "common/images/rectifier.hpp"
#include "common/messages/camera.hpp"
#include "common/messages/converted.hpp"
#include "idl/sensor_msgs.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam {

using messages::ColorMessage;

/// Converts messages to frames: colour becomes grey values, and is rectified.
class FrameConverter {
 public:
  /// Colour and camera info of one instant, with what DepthConverter makes of its depth; refused with a reason when
  /// they are invalid or do not fit each other. The calibration may change from frame to frame; each frame has its own
  /// camera.
  messages::Converted<RgbdFrame> convert(const ColorMessage& color, geometry::DepthImage depth,
                                         const sensor_msgs::msg::CameraInfo& info, time::Time stamp);

 private:
  images::KeptRectifier rectifier_;
};

}  // namespace lapis::slam
