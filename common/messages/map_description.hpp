#pragma once

#include <string>

#include "common/mapping/file/map_description.hpp"
#include "common/messages/converted.hpp"
#include "common/messages/time.hpp"
#include "idl/lapis_msgs.hpp"

namespace lapis::messages {

/// Refused when a value is out of range or not finite (the reason names it), or when a class id is 0 or occurs twice.
Converted<mapping::MapDescription> from_message(const lapis_msgs::msg::MapDescription& message);

lapis_msgs::msg::MapDescription to_message(const mapping::MapDescription& description,
                                           const std_msgs::msg::Header& header);

}  // namespace lapis::messages
