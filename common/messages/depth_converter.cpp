#include "common/messages/depth_converter.hpp"

#include "common/messages/camera.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::messages {
namespace {

constexpr double kMostColorPixels = 16.0;  // that a depth pixel is as wide, or as high, as

/// False for calibrations that cannot be of one sensor; registration would take minutes for an image.
bool fit(const images::RgbdCalibration& cameras) {
  const geometry::PinholeCamera &color = cameras.color.pinhole, &depth = cameras.depth.pinhole;
  return color.fx <= kMostColorPixels * depth.fx && color.fy <= kMostColorPixels * depth.fy &&
         color.width <= kMostColorPixels * depth.width && color.height <= kMostColorPixels * depth.height;
}

}  // namespace

Converted<geometry::DepthImage> DepthConverter::convert(const sensor_msgs::msg::Image& depth,
                                                        const sensor_msgs::msg::CameraInfo& color_info) {
  using Result = Converted<geometry::DepthImage>;
  const auto cameras = calibration(depth.header().frame_id(), color_info);
  if (!cameras) return Result::refused(cameras.reason);
  auto metres = to_depth(depth);
  if (!metres) return metres;
  const auto problem = size_problem("depth", metres->width, metres->height, cameras->depth.pinhole);
  if (!problem.empty()) return Result::refused(problem);
  if (!registration_ || !(registration_->calibration() == *cameras)) registration_.emplace(*cameras);
  return (*registration_)(std::move(*metres));
}

Converted<images::RgbdCalibration> DepthConverter::calibration(const std::string& depth_frame,
                                                               const sensor_msgs::msg::CameraInfo& color_info) const {
  using Result = Converted<images::RgbdCalibration>;
  const auto color = lens_camera(color_info);
  if (!color) return Result::refused(std::string(topics::kColorInfo.name) + ": " + color.reason);
  images::RgbdCalibration cameras{*color, *color};
  if (info_) {
    const auto depth = lens_camera(*info_);
    if (!depth) return Result::refused(std::string(topics::kDepthInfo.name) + ": " + depth.reason);
    cameras.depth = *depth;
    if (!fit(cameras)) {
      return Result::refused(std::string("a pixel of ") + topics::kDepthInfo.name + " is more than 16 of " +
                             topics::kColorInfo.name + ": one of them is wrong");
    }
  }
  const std::string& color_frame = color_info.header().frame_id();
  if (color_frame.empty() || color_frame == depth_frame) return cameras;
  if (!info_) {
    return Result::refused(std::string("depth is not of the frame of ") + topics::kColorInfo.name +
                           ", and nothing has come on " + topics::kDepthInfo.name);
  }
  const auto T_color_depth = transforms_.find(color_frame, depth_frame);
  if (!T_color_depth) {
    return Result::refused(std::string("no transform on ") + topics::kStaticTransforms.name +
                           " connects the frames of depth and colour");
  }
  cameras.T_color_depth = *T_color_depth;
  return cameras;
}

}  // namespace lapis::messages
