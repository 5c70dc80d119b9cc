#pragma once

#include "common/dds/topic.hpp"
#include "idl/tf2_msgs.hpp"

namespace lapis::topics {

// Transforms.
inline constexpr dds::Topic<tf2_msgs::msg::TFMessage> kTransforms{
    "/tf", dds::kBurst, "slam, robot, controller", "camera rate; 50 Hz from a robot", "map -> odom -> base_link",
    true,  true};
inline constexpr dds::Topic<tf2_msgs::msg::TFMessage> kStaticTransforms{
    "/tf_static", dds::kLatchedByMany, "camera", "once", "base_link -> camera_link -> optical frame", true, true};

}  // namespace lapis::topics
