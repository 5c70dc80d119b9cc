#pragma once

#include <vector>

#include "common/messages/camera_frame.hpp"
#include "common/robot/robot_description.hpp"
#include "idl/geometry_msgs.hpp"
#include "simulator/core/simulation.hpp"

namespace lapis::simulator {

/// Names of the camera's frames and of the odometry frame on the wire, with the robot's namespace.
struct SimulatorFrameIds {
  messages::CameraFrameIds camera;
  std::string odom;
};

/// Messages of everything that was sensed since the last frame.
struct SensorMessages {
  messages::CameraMessages camera;
  std::vector<nav_msgs::msg::Odometry> odometry;
  std::vector<tf2_msgs::msg::TFMessage> transforms;  ///< odom -> base_link, one per element of `odometry`
  std::vector<sensor_msgs::msg::Imu> imu;
};

messages::CameraSetUp set_up(const robot::CameraDescription& camera);
SensorMessages to_messages(const SensorFrame& frame, const messages::CameraSetUp& cameras,
                           const SimulatorFrameIds& ids);
DriveCommand from_message(const geometry_msgs::msg::Twist& message);

}  // namespace lapis::simulator
