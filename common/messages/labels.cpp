#include "common/messages/labels.hpp"

#include <stdexcept>

namespace lapis::messages {

Converted<mapping::LabelList> from_message(const vision_msgs::msg::LabelInfo& message) {
  std::vector<std::pair<std::uint16_t, std::string>> names;
  for (const auto& entry : message.class_map()) {
    if (entry.class_id() != 0) names.emplace_back(entry.class_id(), entry.class_name());
  }
  try {
    return mapping::LabelList::from_names(names);
  } catch (const std::runtime_error& error) {
    return Converted<mapping::LabelList>::refused(error.what());
  }
}

vision_msgs::msg::LabelInfo to_message(const mapping::LabelList& labels, time::Time stamp,
                                       const std::string& frame_id) {
  vision_msgs::msg::LabelInfo message;
  message.header(header(stamp, frame_id));
  for (const auto& label : labels.labels()) {
    vision_msgs::msg::VisionClass item;
    item.class_id(label.id);
    item.class_name(label.name);
    message.class_map().push_back(item);
  }
  return message;
}

}  // namespace lapis::messages
