#pragma once

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/messages/converted.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::messages {

/// Camera of a camera info with the distortion model plumb_bob or rational_polynomial, or none; refuses other models,
/// whose numbers mean something else, and a camera without focal length.
Converted<geometry::LensCamera> lens_camera(const sensor_msgs::msg::CameraInfo& message);
/// The same for those who need images without distortion; refuses a distorted camera.
Converted<geometry::PinholeCamera> from_message(const sensor_msgs::msg::CameraInfo& message);

/// Luminance of an rgb8, bgr8, rgba8, bgra8 or mono8 image (ITU-R BT.601 weights).
Converted<geometry::GrayImage> to_gray(const sensor_msgs::msg::Image& message);
/// Metres of a 16UC1 (millimetres; 0 and 65535 = none) or 32FC1 (metres) image; NaN, infinite and negative become 0.
Converted<geometry::DepthImage> to_depth(const sensor_msgs::msg::Image& message);
/// Class ids of a mono8/8UC1 or mono16/16UC1 image; the largest id of the type means unlabelled (vision_msgs), as 0.
Converted<geometry::LabelImage> to_labels(const sensor_msgs::msg::Image& message);
/// Confidence of a 32FC1 (0 to 1; NaN is 0) or mono8 (0 to 255) image.
Converted<geometry::ConfidenceImage> to_confidence(const sensor_msgs::msg::Image& message);

}  // namespace lapis::messages
