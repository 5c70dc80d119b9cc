#include "common/messages/labels.hpp"

#include <gtest/gtest.h>

namespace lapis::messages {
namespace {

TEST(LabelInfo, NamesClassesSkipsUnlabelledAndRefusesRepetition) {
  vision_msgs::msg::LabelInfo message;
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0, 2, 1}) {
    vision_msgs::msg::VisionClass entry;
    entry.class_id(id);
    entry.class_name("name " + std::to_string(id));
    message.class_map().push_back(entry);
  }
  const auto labels = from_message(message);
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->size(), 2u);
  EXPECT_EQ(labels->name(2), "name 2");
  EXPECT_EQ(labels->max_id(), 2);
  message.class_map().push_back(message.class_map().back());
  EXPECT_FALSE(from_message(message));
}

}  // namespace
}  // namespace lapis::messages
