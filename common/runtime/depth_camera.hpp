#pragma once

#include <string>

#include "common/messages/depth_converter.hpp"
#include "common/runtime/context.hpp"
#include "common/topics/camera.hpp"

namespace lapis::runtime {

/// A DepthConverter that listens to the camera info of depth.
class DepthCamera {
 public:
  /// `transforms` are kept up to date by the caller, and outlive this object.
  DepthCamera(Context& context, const messages::StaticTransforms& transforms)
      : converter_(transforms), source_(context.subscribe(topics::kDepthInfo, [this](sensor_msgs::msg::CameraInfo& m) {
          converter_.set_info(std::move(m));
        })) {}
  DepthCamera(const DepthCamera&) = delete;
  DepthCamera& operator=(const DepthCamera&) = delete;

  /// Uses what somebody finds out about the depth camera, where one publishes that.
  void follow(Context& context, const dds::Topic<sensor_msgs::msg::CameraInfo>& topic) {
    estimates_ = &context.subscribe(topic, [this, &context, name = topic.name](const sensor_msgs::msg::CameraInfo& m) {
      const std::string problem = converter_.set_estimate(m);
      if (problem.empty()) return;
      context.status().count(std::string(name) + " dropped: " + problem);
    });
  }
  /// True while the calibration may still come: somebody publishes it, and nothing has arrived.
  bool is_awaited() const {
    if (estimates_ != nullptr && estimates_->matched() > 0 && !converter_.has_estimate()) return true;
    return !converter_.has_info() && source_.matched() > 0;
  }
  messages::DepthConverter& converter() { return converter_; }
  /// See DepthConverter::corrected.
  sensor_msgs::msg::CameraInfo corrected(const sensor_msgs::msg::CameraInfo& color_info) const {
    return converter_.corrected(color_info);
  }
  /// See DepthConverter::convert.
  messages::Converted<geometry::DepthImage> convert(const sensor_msgs::msg::Image& depth,
                                                    const sensor_msgs::msg::CameraInfo& color_info) {
    return converter_.convert(depth, color_info);
  }

 private:
  messages::DepthConverter converter_;
  dds::Source& source_;
  dds::Source* estimates_ = nullptr;
};

}  // namespace lapis::runtime
