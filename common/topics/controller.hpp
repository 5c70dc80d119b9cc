#pragma once

#include "common/dds/topic.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"

namespace lapis::topics {

// What the controller publishes, and what an operator tells it.
inline constexpr dds::Topic<geometry_msgs::msg::Twist> kCommand{"/cmd_vel", dds::kCommand, "controller", "10 to 20 Hz",
                                                                "velocity command"};
inline constexpr dds::Topic<geometry_msgs::msg::Twist> kTeleop{
    "/teleop/cmd_vel", dds::kCommand, "operator", "5 to 20 Hz",
    "velocity that an operator wants; the controller drives as much of it as is free"};
inline constexpr dds::Topic<nav_msgs::msg::Path> kLocalPath{"/controller/local_path", dds::kCommand, "controller",
                                                            "each command", "path that is being followed"};
inline constexpr dds::Topic<lapis_msgs::msg::ControllerStatus> kControllerStatus{
    "/controller/status", dds::kLatched, "controller", "1 Hz and on change", "state and reason"};

}  // namespace lapis::topics
