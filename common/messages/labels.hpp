#pragma once

#include "common/mapping/model/label_list.hpp"
#include "common/messages/converted.hpp"
#include "common/messages/time.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::messages {

/// The classes that a segmentation announces; an entry for id 0, which is only its name for "unlabelled", is left out.
/// Refused when an id occurs twice.
Converted<mapping::LabelList> from_message(const vision_msgs::msg::LabelInfo& message);

/// The message with which a camera or a segmentation announces its classes.
vision_msgs::msg::LabelInfo to_message(const mapping::LabelList& labels, time::Time stamp, const std::string& frame_id);

}  // namespace lapis::messages
