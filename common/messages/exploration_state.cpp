#include "common/messages/exploration_state.hpp"

namespace lapis::messages {

using namespace lapis_msgs::msg::PlannerStatus_Constants;

std::string state_name(const lapis_msgs::msg::PlannerStatus& status) {
  switch (status.state()) {
    case STATE_IDLE: return "IDLE";
    case STATE_EXPLORING: return "EXPLORING";
    case STATE_PAUSED: return "PAUSED";
    case STATE_RECOVERING: return "RECOVERING";
    case STATE_RETURNING: return "RETURNING";
    case STATE_DONE: return "DONE";
    case STATE_GAVE_UP: return "GAVE_UP";
    case STATE_FAILED: return "FAILED";
    case STATE_CONSOLIDATING: return "CONSOLIDATING";
    default: return "UNKNOWN";
  }
}

bool has_ended(const lapis_msgs::msg::PlannerStatus& status) {
  return status.state() == STATE_DONE || status.state() == STATE_GAVE_UP || status.state() == STATE_FAILED;
}

}  // namespace lapis::messages
