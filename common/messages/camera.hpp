#pragma once

#include <cstring>
#include <string>
#include <variant>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/messages/converted.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::messages {

/// Camera of a camera info with the distortion model plumb_bob or rational_polynomial, or without distortion; refuses
/// other models, whose coefficients mean something else, and a camera without valid size and focal length.
Converted<geometry::LensCamera> lens_camera(const sensor_msgs::msg::CameraInfo& message);
/// Inverse of lens_camera, for images that are not rectified by anybody else.
sensor_msgs::msg::CameraInfo to_camera_info(const geometry::LensCamera& camera, const std_msgs::msg::Header& header);
/// Why an image does not have the size of its camera; empty when it has. `what`: "depth".
std::string size_problem(const std::string& what, int width, int height, const geometry::PinholeCamera& camera);

/// A colour image as received: raw or compressed.
using ColorMessage = std::variant<sensor_msgs::msg::Image, sensor_msgs::msg::CompressedImage>;

/// Most pixels of a compressed image that is decoded: a few bytes may announce any number.
inline constexpr int kMostDecodedPixels = 1 << 25;

/// Colours of an image of any encoding that to_gray() reads, or of a JPEG or PNG.
Converted<geometry::ColorImage> to_color(const sensor_msgs::msg::Image& message);
Converted<geometry::ColorImage> to_color(const sensor_msgs::msg::CompressedImage& message);
/// Luminance of an rgb8, bgr8, rgba8, bgra8, mono8 (8UC1) or yuv422 image (ITU-R BT.601 weights; yuv422 and uyvy have
/// Cb first, yuv422_yuy2 and yuyv Y). Of a mono16 (16UC1) image, as infra-red cameras send it in a part of the range,
/// the brightest 1 % become 255.
Converted<geometry::GrayImage> to_gray(const sensor_msgs::msg::Image& message);
/// Depth in metres of a 16UC1 (millimetres; 0 and 65535 = none) or 32FC1 (metres) image; NaN, infinite and negative
/// values become 0.
Converted<geometry::DepthImage> to_depth(const sensor_msgs::msg::Image& message);
/// Class ids of a mono8/8UC1 or mono16/16UC1 image; the largest id of the type means unlabelled (vision_msgs) and
/// becomes 0.
Converted<geometry::LabelImage> to_labels(const sensor_msgs::msg::Image& message);
/// Confidence (0 to 255) of a 32FC1 (0 to 1; NaN becomes 0) or mono8/8UC1 (0 to 255) image.
Converted<geometry::ConfidenceImage> to_confidence(const sensor_msgs::msg::Image& message);

/// The message of an image; values in the byte order of this machine.
template <class Pixel>
sensor_msgs::msg::Image to_image(const geometry::Image<Pixel>& image, const std::string& encoding,
                                 const std_msgs::msg::Header& header) {
  sensor_msgs::msg::Image message;
  message.header(header);
  message.width(static_cast<std::uint32_t>(image.width));
  message.height(static_cast<std::uint32_t>(image.height));
  message.encoding(encoding);
  message.is_bigendian(0);
  message.step(static_cast<std::uint32_t>(static_cast<std::size_t>(image.width) * sizeof(Pixel)));
  message.data().resize(image.pixels.size() * sizeof(Pixel));
  std::memcpy(message.data().data(), image.pixels.data(), message.data().size());
  return message;
}
/// Inverse of to_labels: mono8 if all ids are below 255, which would mean "unlabelled" (vision_msgs); otherwise mono16.
sensor_msgs::msg::Image to_label_image(const geometry::LabelImage& labels, const std_msgs::msg::Header& header);

}  // namespace lapis::messages
