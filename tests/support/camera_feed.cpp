#include "tests/support/camera_feed.hpp"

#include <cstdlib>

#include "common/topics/camera.hpp"
#include "common/topics/transforms.hpp"
#include "idl/diagnostic_msgs.hpp"

namespace lapis::test {

CameraFeed::CameraFeed(TopicProbe& probe, const std::string& frame_prefix, const SyntheticCamera& camera)
    : camera_(camera), prefix_(frame_prefix), color_(probe.advertise(topics::kColor)),
      depth_(probe.advertise(topics::kDepth)), labels_(probe.advertise(topics::kLabels)),
      color_info_(probe.advertise(topics::kColorInfo)), depth_info_(probe.advertise(topics::kDepthInfo)) {
  probe.advertise(topics::kStaticTransforms).publish(camera_mount(frame_prefix));
  probe.advertise(topics::kLabelInfo).publish(camera_.label_info());
}

CameraFrame CameraFeed::frame(time::Time stamp, const geometry::Pose& T_box_camera) const {
  CameraFrame frame{camera_.color(stamp, T_box_camera), camera_.depth(stamp, T_box_camera),
                    camera_.labels(stamp, T_box_camera), camera_.info(stamp)};
  const std::string id = prefix_ + SyntheticCamera::kOpticalFrame;
  for (auto* image : {&frame.color, &frame.depth, &frame.labels}) (*image)->header().frame_id(id);
  frame.info->header().frame_id(id);
  return frame;
}

void CameraFeed::send(const CameraFrame& frame) {
  if (frame.info) color_info_.publish(*frame.info);
  if (frame.info) depth_info_.publish(*frame.info);
  if (frame.color) color_.publish(*frame.color);
  if (frame.depth) depth_.publish(*frame.depth);
  if (frame.labels) labels_.publish(*frame.labels);
}

std::map<std::string, std::string> newest_values(const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics,
                                                 const std::string& component) {
  std::map<std::string, std::string> values;
  for (const auto& array : diagnostics) {
    for (const auto& status : array.status()) {
      if (status.hardware_id() != component) continue;
      values.clear();
      for (const auto& pair : status.values()) values[pair.key()] = pair.value();
    }
  }
  return values;
}

double sum_of(const std::map<std::string, std::string>& values, const std::string& text) {
  double sum = 0.0;
  for (const auto& [key, value] : values) {
    if (key.find(text) != std::string::npos) sum += std::atof(value.c_str());
  }
  return sum;
}

}  // namespace lapis::test
