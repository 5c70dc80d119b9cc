#include "common/cdr/layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "idl/type_table.hpp"

namespace lapis::cdr {
namespace {

using ::testing::HasSubstr;

TEST(Layout, OfEveryTypeOfThisBuildIsRead) {
  for (const idl::TypeEntry& entry : idl::type_table()) {
    EXPECT_NO_THROW(parse_ros2msg(entry.ros_name, entry.ros2msg_text)) << entry.ros_name;
  }
}

TEST(Layout, HasFieldsButNeitherConstantsNorComments) {
  const Layout layout = parse_ros2msg("a_msgs/msg/Outer", R"(# what it is
byte LARGE=1
string NAME="a = b"
Inner[3] inner   # three
b_msgs/msg/Other[<=4] others
string<=5 text
string<=5[] texts
char letter
float64 factor 1.0
================================================================================
MSG: a_msgs/Inner
int8[] small
================================================================================
MSG: b_msgs/Other
)");
  ASSERT_EQ(layout.structures.size(), 3U);
  const auto& fields = layout.structures[0].fields;
  ASSERT_EQ(fields.size(), 6U);
  EXPECT_EQ(fields[0].name, "inner");
  EXPECT_EQ(fields[0].container, Container::kArray);
  EXPECT_EQ(fields[0].capacity, 3U);
  EXPECT_EQ(fields[0].structure, 1U);
  EXPECT_EQ(fields[1].container, Container::kSequence);
  EXPECT_EQ(fields[1].capacity, 4U);
  EXPECT_EQ(fields[1].structure, 2U);
  EXPECT_EQ(fields[2].string_bound, 5U);
  EXPECT_EQ(fields[3].string_bound, 5U);
  EXPECT_EQ(fields[3].container, Container::kSequence);
  EXPECT_EQ(fields[4].kind, Kind::kUint8);
  EXPECT_EQ(fields[5].name, "factor");
  EXPECT_TRUE(layout.structures[2].fields.empty());
}

std::string refusal(const std::string& text) {
  try {
    parse_ros2msg("a_msgs/msg/Tested", text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Layout, OfAnotherTextIsRefusedWithItsLine) {
  EXPECT_THAT(refusal("int32\n"), HasSubstr("'int32'"));
  EXPECT_THAT(refusal("int32[x] a\n"), HasSubstr("'x' is no size"));
  EXPECT_THAT(refusal("int32] a\n"), HasSubstr("no ["));
  EXPECT_THAT(refusal("Missing a\n"), HasSubstr("a_msgs/Missing is not declared"));
  EXPECT_THAT(refusal("Tested a\n"), HasSubstr("contains itself"));
}

}  // namespace
}  // namespace lapis::cdr
