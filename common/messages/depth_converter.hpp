#pragma once

#include <optional>
#include <string>

#include "common/geometry/image.hpp"
#include "common/images/depth_registration.hpp"
#include "common/messages/converted.hpp"
#include "common/messages/geometry.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::messages {

/// Brings the depth images of an RGB-D sensor to the view of its colour camera, by the camera infos of both and the
/// static transforms. Without a camera info of depth, depth of the colour camera's frame counts as registered to it.
class DepthConverter {
 public:
  /// `transforms` are kept up to date by the caller, and outlive this object.
  explicit DepthConverter(const StaticTransforms& transforms) : transforms_(transforms) {}

  /// The newest calibration of the depth camera.
  void set_info(sensor_msgs::msg::CameraInfo info) { info_ = std::move(info); }
  bool has_info() const { return info_.has_value(); }
  /// Depth [m] of the size of the colour camera, along the axis of that camera without its lens distortion; refused
  /// with the reason when image, calibrations and frames do not fit each other.
  Converted<geometry::DepthImage> convert(const sensor_msgs::msg::Image& depth,
                                          const sensor_msgs::msg::CameraInfo& color_info);

 private:
  Converted<images::RgbdCalibration> calibration(const std::string& depth_frame,
                                                 const sensor_msgs::msg::CameraInfo& color_info) const;

  const StaticTransforms& transforms_;
  std::optional<sensor_msgs::msg::CameraInfo> info_;
  std::optional<images::DepthRegistration> registration_;  // made once per calibration
};

}  // namespace lapis::messages
