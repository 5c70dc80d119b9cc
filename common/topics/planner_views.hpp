#pragma once

#include "common/dds/topic.hpp"
#include "idl/visualization_msgs.hpp"

namespace lapis::topics {

// What the planner publishes for viewers.
inline constexpr dds::Topic<visualization_msgs::msg::MarkerArray> kPlannerMarkers{
    "/planner/markers", dds::kLatched, "planner", "each decision",
    "frontiers, candidates, hallucinated graph; made only for readers"};

}  // namespace lapis::topics
