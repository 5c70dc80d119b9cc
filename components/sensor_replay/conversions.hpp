#pragma once

#include <optional>
#include <vector>

#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/tf2_msgs.hpp"
#include "idl/vision_msgs.hpp"
#include "sensor_replay/core/tum_dataset.hpp"

namespace lapis::sensor_replay {

/// Frame ids as they go on the wire, with the robot's namespace.
struct FrameIds {
  std::string base;
  std::string camera;
  std::string optical;
  std::string world;
};

/// The messages of one frame; they all carry its stamp.
struct FrameMessages {
  sensor_msgs::msg::Image color;
  sensor_msgs::msg::CameraInfo info;
  std::optional<sensor_msgs::msg::Image> depth;
  std::optional<sensor_msgs::msg::Image> labels;
  std::optional<nav_msgs::msg::Odometry> ground_truth;  ///< base_link in the data set's world
};

FrameMessages to_messages(const ReplayFrame& frame, const CameraFile& camera, const FrameIds& ids);
/// base_link -> camera_link -> optical frame, in one message, as /tf_static wants it.
tf2_msgs::msg::TFMessage to_static_transforms(const CameraMount& mount, const FrameIds& ids, time::Time stamp);
vision_msgs::msg::LabelInfo to_message(const std::vector<ClassName>& classes, const FrameIds& ids, time::Time stamp);

}  // namespace lapis::sensor_replay
