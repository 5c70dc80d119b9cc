#include "common/messages/depth_converter.hpp"

#include <algorithm>
#include <cmath>

#include "common/messages/camera.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::messages {
namespace {

constexpr double kMostColorPixels = 16.0;  // that a depth pixel is as wide, or as high, as

constexpr std::size_t kMostEstimates = 8;

/// False for calibrations that cannot be of one sensor; registration would take minutes for an image.
bool fit(const images::RgbdCalibration& cameras) {
  const geometry::PinholeCamera &color = cameras.color.pinhole, &depth = cameras.depth.pinhole;
  return color.fx <= kMostColorPixels * depth.fx && color.fy <= kMostColorPixels * depth.fy &&
         color.width <= kMostColorPixels * depth.width && color.height <= kMostColorPixels * depth.height;
}

/// Rotation and position of the depth camera by `r` and `p`; refused where these are not of a pair of cameras.
Converted<geometry::Pose> beside_color(const sensor_msgs::msg::CameraInfo& info) {
  using Result = Converted<geometry::Pose>;
  const auto& p = info.p();
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.r().data());
  const Eigen::Vector3d t{-p[3] / p[0], -p[7] / p[5], -p[11]};
  constexpr double kRounding = 1e-3;
  const bool is_rotation = R.allFinite() && (R * R.transpose()).isIdentity(kRounding) && R.determinant() > 0.0;
  const bool is_projection = p[0] > 0.0 && p[5] > 0.0 && std::isfinite(p[0]) && std::isfinite(p[5]);
  if (!is_rotation || !is_projection || !t.allFinite()) return Result::refused("r and p are not of a pair of cameras");
  return geometry::make_pose(t, Eigen::Quaterniond(R));
}

}  // namespace

sensor_msgs::msg::CameraInfo to_depth_info(const std_msgs::msg::Header& header,
                                           const images::RgbdCalibration& cameras) {
  const geometry::PinholeCamera &color = cameras.color.pinhole, &depth = cameras.depth.pinhole;
  sensor_msgs::msg::CameraInfo info = to_camera_info(cameras.depth, header);
  const Eigen::Matrix3d R = cameras.T_color_depth.linear();
  const Eigen::Vector3d t = cameras.T_color_depth.translation();
  std::size_t at = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) info.r()[at++] = R(row, column);
  }
  info.p(
      {color.fx, 0.0, depth.cx, -color.fx * t.x(), 0.0, color.fy, depth.cy, -color.fy * t.y(), 0.0, 0.0, 1.0, -t.z()});
  return info;
}

std::string DepthConverter::set_estimate(const sensor_msgs::msg::CameraInfo& info) {
  const auto depth = lens_camera(info);
  if (!depth) return depth.reason;
  const auto T_color_depth = beside_color(info);
  if (!T_color_depth) return T_color_depth.reason;
  const time::Time since = from_message(info.header().stamp());
  std::erase_if(estimates_, [&](const Estimate& other) { return other.since >= since; });
  if (estimates_.size() >= kMostEstimates) estimates_.erase(estimates_.begin());
  estimates_.push_back({since, info.p()[0], info.p()[5], *depth, *T_color_depth});
  return "";
}

void DepthConverter::note_given(const Converted<images::RgbdCalibration>& given, time::Time stamp) {
  const bool is_same = given_.has_value() == given.value.has_value() && (!given_ || *given_ == *given);
  if (has_converted_ && !is_same) std::erase_if(estimates_, [&](const Estimate& e) { return e.since < stamp; });
  given_ = given.value;
  has_converted_ = true;
}

const DepthConverter::Estimate& DepthConverter::newest_estimate(time::Time stamp) const {
  const auto later = std::find_if(estimates_.begin(), estimates_.end(),
                                  [&](const Estimate& estimate) { return estimate.since > stamp; });
  return later == estimates_.begin() ? *later : *(later - 1);
}

sensor_msgs::msg::CameraInfo DepthConverter::corrected(sensor_msgs::msg::CameraInfo color_info) const {
  if (estimates_.empty()) return color_info;
  const Estimate& estimate = newest_estimate(from_message(color_info.header().stamp()));
  color_info.k()[0] = estimate.color_fx;
  color_info.k()[4] = estimate.color_fy;
  return color_info;
}

const DepthConverter::Estimate* DepthConverter::estimate_at(time::Time stamp, const geometry::LensCamera& color,
                                                            int width, int height) const {
  if (estimates_.empty()) return nullptr;
  const Estimate& found = newest_estimate(stamp);
  const geometry::PinholeCamera& camera = found.depth.pinhole;
  const bool is_usable = camera.width == width && camera.height == height && fit({color, found.depth, {}});
  return is_usable ? &found : nullptr;
}

Converted<geometry::DepthImage> DepthConverter::convert(const sensor_msgs::msg::Image& depth,
                                                        const sensor_msgs::msg::CameraInfo& color_info) {
  using Result = Converted<geometry::DepthImage>;
  auto cameras = given(depth.header().frame_id(), color_info);
  auto metres = to_depth(depth);
  if (!metres) return metres;
  if (has_estimate()) {
    const time::Time stamp = from_message(color_info.header().stamp());
    note_given(cameras, stamp);
    const auto color = lens_camera(corrected(color_info));
    if (!color) return Result::refused(color.reason);
    if (const Estimate* estimate = estimate_at(stamp, *color, metres->width, metres->height)) {
      cameras = images::RgbdCalibration{*color, estimate->depth, estimate->T_color_depth};
    } else {
      estimates_.clear();
    }
  }
  if (!cameras) return Result::refused(cameras.reason);
  const auto problem = size_problem("depth", metres->width, metres->height, cameras->depth.pinhole);
  if (!problem.empty()) return Result::refused(problem);
  if (!registration_ || !(registration_->calibration() == *cameras)) registration_.emplace(*cameras);
  return (*registration_)(std::move(*metres));
}

Converted<images::RgbdCalibration> DepthConverter::given(const std::string& depth_frame,
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
