#pragma once

#include <string>

#include "idl/lapis_msgs.hpp"

namespace lapis::messages {

/// Name of the state as in the constants of lapis_msgs, such as "EXPLORING"; "UNKNOWN" for any other number.
std::string state_name(const lapis_msgs::msg::PlannerStatus& status);
/// True when the planner is DONE, GAVE_UP or FAILED, so that it does not move the robot any more.
bool has_ended(const lapis_msgs::msg::PlannerStatus& status);

}  // namespace lapis::messages
