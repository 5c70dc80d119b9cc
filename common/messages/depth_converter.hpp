#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/images/depth_registration.hpp"
#include "common/messages/converted.hpp"
#include "common/messages/geometry.hpp"
#include "common/time/time.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::messages {

/// The depth camera beside that of colour, as for stereo cameras in ROS: `r` turns to the axes of colour, `p` projects
/// from the frame of colour, which the header names, with the focal lengths of colour.
sensor_msgs::msg::CameraInfo to_depth_info(const std_msgs::msg::Header& header, const images::RgbdCalibration& cameras);

/// Brings the depth images of an RGB-D sensor to the view of its colour camera, by the camera infos of both and the
/// static transforms. Without a camera info of depth, depth of the colour camera's frame counts as registered to it.
class DepthConverter {
 public:
  /// `transforms` are kept up to date by the caller, and outlive this object.
  explicit DepthConverter(const StaticTransforms& transforms) : transforms_(transforms) {}

  /// The newest calibration of the depth camera.
  void set_info(sensor_msgs::msg::CameraInfo info) { info_ = std::move(info); }
  bool has_info() const { return info_.has_value(); }
  /// What was found out about both cameras (to_depth_info); from its stamp on, it counts instead of camera info and
  /// transforms of depth, and of the focal lengths of colour, until any of these change. Returns why it cannot be used,
  /// or an empty text.
  std::string set_estimate(const sensor_msgs::msg::CameraInfo& info);
  bool has_estimate() const { return !estimates_.empty(); }
  /// The camera info of colour with the focal lengths that were found out. For images whose depth has been converted.
  sensor_msgs::msg::CameraInfo corrected(sensor_msgs::msg::CameraInfo color_info) const;
  /// By what the newest image was converted.
  const images::RgbdCalibration* used() const { return registration_ ? &registration_->calibration() : nullptr; }
  /// Depth [m] of the size of the colour camera, along the axis of that camera without its lens distortion; refused
  /// with the reason when image, calibrations and frames do not fit each other.
  Converted<geometry::DepthImage> convert(const sensor_msgs::msg::Image& depth,
                                          const sensor_msgs::msg::CameraInfo& color_info);

 private:
  struct Estimate {
    time::Time since;
    double color_fx = 0.0, color_fy = 0.0;  // [px]
    geometry::LensCamera depth;
    geometry::Pose T_color_depth = geometry::Pose::Identity();
  };
  /// By camera infos and transforms.
  Converted<images::RgbdCalibration> given(const std::string& depth_frame,
                                           const sensor_msgs::msg::CameraInfo& color_info) const;
  /// Forgets estimates from before `stamp` when what is given has changed since the last image.
  void note_given(const Converted<images::RgbdCalibration>& given, time::Time stamp);
  /// Of an image; before the oldest estimate that one. Nothing when there is none of this size.
  const Estimate* estimate_at(time::Time stamp, const geometry::LensCamera& color, int width, int height) const;
  const Estimate& newest_estimate(time::Time stamp) const;

  const StaticTransforms& transforms_;
  std::optional<sensor_msgs::msg::CameraInfo> info_;
  std::vector<Estimate> estimates_;               // the newest ones, by time
  std::optional<images::RgbdCalibration> given_;  // for the last image
  bool has_converted_ = false;
  std::optional<images::DepthRegistration> registration_;  // made once per calibration
};

}  // namespace lapis::messages
