#include "command_line/core/parameters.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace lapis::command_line {
namespace {

using cdr::Value;

TEST(Parameters, HaveTheContentOfTheirType) {
  const Value value{{"type", 3}, {"bool_value", true}, {"double_value", 2.5}, {"string_array_value", {"a"}}};
  EXPECT_EQ(content_of(value), 2.5);
  EXPECT_TRUE(content_of({{"type", 0}}).is_null());
  EXPECT_TRUE(content_of({{"type", 77}}).is_null());
  EXPECT_TRUE(content_of({}).is_null());
}

TEST(Parameters, TakeATextAsTheTypeThatTheyHave) {
  EXPECT_EQ(to_parameter_value("5", 3), (Value{{"type", 3}, {"double_value", "5"}}));
  EXPECT_EQ(to_parameter_value("5", 4), (Value{{"type", 4}, {"string_value", "5"}}));
  EXPECT_EQ(to_parameter_value("a: b", 4), (Value{{"type", 4}, {"string_value", "a: b"}}));
  EXPECT_EQ(to_parameter_value("[1, 2]", 7), (Value{{"type", 7}, {"integer_array_value", {"1", "2"}}}));
  EXPECT_THROW(to_parameter_value("[1]", 2), std::runtime_error);
  EXPECT_THROW(to_parameter_value("1", 7), std::runtime_error);
  EXPECT_THROW(to_parameter_value("{a: 1}", 3), std::runtime_error);
  EXPECT_THROW(to_parameter_value("1", 77), std::runtime_error);
}

TEST(Parameters, WithoutATypeTakeThatOfTheText) {
  EXPECT_EQ(to_parameter_value("true", 0)["type"], 1);
  EXPECT_EQ(to_parameter_value("-5", 0)["type"], 2);
  EXPECT_EQ(to_parameter_value("5.5", 0)["type"], 3);
  EXPECT_EQ(to_parameter_value("five", 0)["type"], 4);
  EXPECT_EQ(to_parameter_value("[true]", 0)["type"], 6);
  EXPECT_EQ(to_parameter_value("[1]", 0)["type"], 7);
  EXPECT_EQ(to_parameter_value("[1.5]", 0)["type"], 8);
  EXPECT_EQ(to_parameter_value("[]", 0)["type"], 9);
}

TEST(Parameters, AreATree) {
  EXPECT_EQ(as_tree({{"a.b.c", 1}, {"a.b.d", 2}, {"e", 3}}), (Value{{"a", {{"b", {{"c", 1}, {"d", 2}}}}}, {"e", 3}}));
}

}  // namespace
}  // namespace lapis::command_line
