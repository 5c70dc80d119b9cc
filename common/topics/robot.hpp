#pragma once

#include "common/dds/topic.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::topics {

// What a robot publishes besides its camera images.
inline constexpr dds::Topic<nav_msgs::msg::Odometry> kWheelOdometry{
    "/odom", dds::kBurst, "robot", "50 Hz",
    "optional; wheel odometry, drifting. With controller.publish_odometry: from the controller's commands"};
inline constexpr dds::Topic<sensor_msgs::msg::Imu> kImu{"/imu", dds::kBurst, "robot", "200 Hz", "optional"};

}  // namespace lapis::topics
