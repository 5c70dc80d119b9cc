#pragma once

#include <variant>

#include "common/geometry/pinhole_camera.hpp"
#include "common/images/rectifier.hpp"
#include "common/messages/converted.hpp"
#include "idl/sensor_msgs.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam {

/// A colour image as received: raw or compressed.
using ColorMessage = std::variant<sensor_msgs::msg::Image, sensor_msgs::msg::CompressedImage>;

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
