#include "common/cdr/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace lapis::cdr {
namespace {

using ::testing::HasSubstr;

const Value kMessage{
    {"header", {{"stamp", {{"sec", 1}, {"nanosec", 5}}}, {"frame_id", "map"}}},
    {"data", {1, 2, 3}},
    {"transforms", Value::array({{{"x", 1.0}, {"list", {true}}}, {{"x", 1e-7}, {"list", Value::array()}}})},
    {"empty", Value::object()},
    {"text", ""}};

TEST(MessageText, IsAsRos2TopicEchoPrintsIt) {
  EXPECT_EQ(to_yaml(kMessage), R"(header:
  stamp:
    sec: 1
    nanosec: 5
  frame_id: map
data:
- 1
- 2
- 3
transforms:
- x: 1.0
  list:
  - true
- x: 1e-07
  list: []
empty: {}
text: ''
)");
}

TEST(MessageText, IsReadAsTheSameMessage) {
  const Value read = from_yaml(to_yaml(kMessage));
  EXPECT_EQ(read["header"]["stamp"]["nanosec"], "5");
  EXPECT_EQ(read["transforms"][1]["x"], "1e-07");
  EXPECT_EQ(read["text"], "");
  EXPECT_EQ(from_yaml(R"({"data": [1, "two"], "none": null})"), Value({{"data", {"1", "two"}}, {"none", nullptr}}));
  EXPECT_TRUE(from_yaml("").is_null());
  EXPECT_THROW(from_yaml("{a: [1"), std::runtime_error);
}

TEST(MessageText, QuotesWhatYamlWouldTakeForSomethingElse) {
  for (const char* text : {"yes", "12", "a: b", "- a", "null", " a", "a ", "two\nlines", "#", "{", "0x10", "a#"}) {
    EXPECT_EQ(from_yaml(to_yaml({{"text", text}}))["text"], text);
    EXPECT_THAT(to_yaml({{"text", text}}), HasSubstr("text: \"")) << text;
  }
  EXPECT_EQ(to_yaml({{"text", "standing still (lost), 2.5 s"}}), "text: standing still (lost), 2.5 s\n");
}

TEST(MessageText, LeavesOutTheRestOfLongLists) {
  EXPECT_EQ(to_yaml({{"data", {1, 2, 3}}}, 2), "data:\n- 1\n- 2\n- '...'\n");
}

TEST(MessageText, SaysWhichNumbersAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_yaml({{"a", nan}, {"b", infinity}, {"c", -infinity}}), "a: .nan\nb: .inf\nc: -.inf\n");
  EXPECT_EQ(to_json({{"a", nan}}), R"({"a":null})");
  EXPECT_EQ(to_json({{"a", "\xff"}}), "{\"a\":\"\xef\xbf\xbd\"}");
}

TEST(MessageText, OfAField) {
  EXPECT_EQ(field_of(kMessage, "header.frame_id"), "map");
  EXPECT_EQ(field_of(kMessage, "transforms[1].x"), 1e-7);
  EXPECT_EQ(field_of(kMessage, "transforms.1.x"), 1e-7);
  EXPECT_EQ(to_yaml(field_of(kMessage, "data")), "- 1\n- 2\n- 3\n");
  EXPECT_EQ(to_yaml(field_of(kMessage, "header.stamp.sec")), "1\n");
  for (const auto& [path, problem] : {std::pair{"header.x", "there is stamp, frame_id"},
                                      {"data[3]", "a list of 3"},
                                      {"text.x", "no fields"},
                                      {"", "there is header, data"}}) {
    try {
      field_of(kMessage, path);
      FAIL() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(problem));
    }
  }
}

}  // namespace
}  // namespace lapis::cdr
