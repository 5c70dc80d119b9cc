#pragma once

#include "common/dds/topic.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::topics {

// What a robot publishes besides its camera images.
inline constexpr dds::Topic<nav_msgs::msg::Odometry> kWheelOdometry{
    "/odom", dds::kSensorBurst, "robot, controller", "50 Hz",
    "optional; wheel odometry, drifting; from the controller: where its commands lead, with each of them"};
inline constexpr dds::Topic<sensor_msgs::msg::Imu> kImu{"/imu", dds::kSensorBurst, "robot", "200 Hz", "optional"};

}  // namespace lapis::topics
