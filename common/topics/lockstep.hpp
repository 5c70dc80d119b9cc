#pragma once

#include "common/dds/topic.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/rosgraph_msgs.hpp"

namespace lapis::topics {

// Time and lock-step.
inline constexpr dds::Topic<rosgraph_msgs::msg::Clock> kClock{
    "/clock", {.depth = 10, .urgent = true}, "simulator, sensor_replay", "each tick", "time of the newest data", true};
inline constexpr dds::Topic<lapis_msgs::msg::Tick> kTick{
    "/sim/tick",
    dds::kLockstep,
    "simulator, sensor_replay",
    "each stage of a tick",
    "releases a stage of lock-step with the counts of samples known so far",
    true};
inline constexpr dds::Topic<lapis_msgs::msg::Ack> kAck{"/sim/ack",
                                                       dds::kLockstep,
                                                       "all that take part",
                                                       "each stage of a tick",
                                                       "answer to a tick with the counts of samples published",
                                                       true,
                                                       true};

}  // namespace lapis::topics
