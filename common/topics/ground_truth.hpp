#pragma once

#include "common/dds/topic.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::topics {

// Ground truth: only the evaluator and tests may read these.
inline constexpr dds::Topic<nav_msgs::msg::Odometry> kGroundTruth{
    "/ground_truth/odom", dds::kFrameState, "simulator, sensor_replay", "camera rate", "true pose of base_link"};
inline constexpr dds::Topic<std_msgs::msg::Bool> kCollision{"/ground_truth/collision", dds::kState, "simulator",
                                                            "on change", "the robot touches something"};

}  // namespace lapis::topics
