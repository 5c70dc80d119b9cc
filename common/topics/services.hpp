#pragma once

#include "common/dds/topic.hpp"
#include "idl/std_srvs.hpp"

namespace lapis::topics {

// The services.
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kSaveMap{"/semantic_mapper/save", "semantic_mapper",
                                                                    "save map.lapis, map.ot and map.ply now"};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kPause{"/sim/pause", "simulator", "no further tick", true};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kRun{"/sim/run", "simulator", "resume after a pause", true};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kStep{"/sim/step", "simulator", "pause, but for one tick",
                                                                 true, true};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kReset{"/sim/reset", "simulator",
                                                                  "back to the start and to time 0: a new run", true};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kStartExploring{"/planner/start", "planner",
                                                                           "explore, also after a pause or the end"};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kStopExploring{"/planner/stop", "planner",
                                                                          "stand still, idle"};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kPauseExploring{"/planner/pause", "planner",
                                                                           "stand still until /planner/start"};
inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kReturnHome{"/planner/return_home", "planner",
                                                                       "drive to where exploration began"};

inline constexpr dds::ServiceTopic<std_srvs::srv::Trigger> kSnapshot{"/recorder/snapshot", "recorder",
                                                                     "write the last seconds as a bag", false, true};

}  // namespace lapis::topics
