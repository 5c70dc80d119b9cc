#pragma once

#include <optional>
#include <string>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/time/time.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/tf2_msgs.hpp"

namespace lapis::messages {

/// Frame ids as in messages, with the robot's namespace.
struct CameraFrameIds {
  std::string base;
  std::string camera;
  std::string optical;        ///< of colour
  std::string depth_optical;  ///< of a depth camera of its own
  std::string world;
};

/// The depth camera of a sensor whose depth is not registered to colour.
struct DepthCamera {
  geometry::PinholeCamera camera;
  geometry::Pose T_color_depth;  ///< in the optical frame of colour
};

/// What does not change from frame to frame.
struct CameraSetUp {
  geometry::CameraMount mount;  ///< of colour
  geometry::PinholeCamera color;
  std::optional<DepthCamera> depth;  ///< none: depth is registered to colour
};

/// Images of an RGB-D camera at one time, with their labels and ground truth. The images belong to the caller and have
/// the size of their camera; null or empty: not available.
struct CameraFrame {
  time::Time stamp;
  const geometry::ColorImage& color;
  const geometry::Image<std::uint16_t>* depth_mm = nullptr;
  const geometry::LabelImage* labels = nullptr;
  std::optional<geometry::Pose> T_world_base;  ///< ground truth
};

/// The messages of one frame; they all carry its stamp.
struct CameraMessages {
  sensor_msgs::msg::Image color;
  sensor_msgs::msg::CameraInfo color_info, depth_info;
  std::optional<sensor_msgs::msg::Image> depth;
  std::optional<sensor_msgs::msg::Image> labels;
  std::optional<nav_msgs::msg::Odometry> ground_truth;  ///< base_link in the world
};

CameraMessages to_messages(const CameraFrame& frame, const CameraSetUp& cameras, const CameraFrameIds& ids);
/// base_link -> camera_link -> optical frame of colour (-> that of depth) in one message, as /tf_static requires.
tf2_msgs::msg::TFMessage to_static_transforms(const CameraSetUp& cameras, const CameraFrameIds& ids, time::Time stamp);

}  // namespace lapis::messages
