#pragma once

#include "common/dds/topic.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"

namespace lapis::topics {

// What the planner publishes.
inline constexpr dds::Topic<nav_msgs::msg::Path> kPlannerPath{
    "/planner/path", dds::kLatched, "planner", "on change",
    "path to the chosen goal, with the headings of a first turn; in base_link: a turn on the spot"};
inline constexpr dds::Topic<lapis_msgs::msg::CandidateSet> kCandidates{
    "/planner/candidates", dds::kLatched, "planner", "each decision", "cost, information, utility of every candidate"};
inline constexpr dds::Topic<geometry_msgs::msg::PoseStamped> kGoal{
    "/planner/goal",
    dds::kCommand,
    "whoever steers",
    "on demand",
    "drive there instead of exploring; an orientation of zeros: any heading",
    false,
    true};
inline constexpr dds::Topic<lapis_msgs::msg::PlannerStatus> kPlannerStatus{
    "/planner/status", dds::kLatched, "planner", "each frame and on change", "state and reason"};

}  // namespace lapis::topics
