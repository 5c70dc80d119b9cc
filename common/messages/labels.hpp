#pragma once

#include "common/mapping/label_list.hpp"
#include "common/messages/converted.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::messages {

/// The classes that a segmentation announces; an entry for id 0 only says how it calls "unlabelled" and is left out.
/// Refused when an id occurs twice.
Converted<mapping::LabelList> from_message(const vision_msgs::msg::LabelInfo& message);

}  // namespace lapis::messages
