#pragma once

#include "common/dds/topic.hpp"
#include "idl/lapis_msgs.hpp"

namespace lapis::topics {

// Heartbeats of every process except the supervisor.
inline constexpr dds::Topic<lapis_msgs::msg::Heartbeat> kHeartbeat{"/heartbeat",
                                                                   dds::kLatchedByMany,
                                                                   "all but the supervisor",
                                                                   "2 Hz and before long work",
                                                                   "life, phase and activity, for the supervisor",
                                                                   true,
                                                                   true};

}  // namespace lapis::topics
