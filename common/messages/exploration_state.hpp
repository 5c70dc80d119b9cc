#pragma once

#include <string>

#include "idl/lapis_msgs.hpp"

namespace lapis::messages {

/// "EXPLORING" and so on, as the constants of lapis_msgs are called; "UNKNOWN" for a number that is none of them.
std::string state_name(const lapis_msgs::msg::PlannerStatus& status);
/// The planner is DONE, GAVE_UP or has FAILED: it will not move the robot any more.
bool has_ended(const lapis_msgs::msg::PlannerStatus& status);

}  // namespace lapis::messages
