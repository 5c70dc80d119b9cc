// A configuration key as a parameter of ROS 2: value, descriptor, and what it may be set to.
#include "common/parameters/parameter_value.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lapis::parameters {
namespace {

using rcl_interfaces::msg::ParameterValue;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
namespace types = rcl_interfaces::msg::ParameterType_Constants;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Value>
config::Entry key(Value& value, config::Bound bound = config::anything()) {
  return {"slam.key", &value, std::move(bound), "what it is", config::Change::kAtRunTime};
}

ParameterValue of_type(std::uint8_t type) {
  ParameterValue value;
  value.type(type);
  return value;
}
ParameterValue boolean(bool v) {
  auto value = of_type(types::PARAMETER_BOOL);
  value.bool_value(v);
  return value;
}
ParameterValue integer(std::int64_t v) {
  auto value = of_type(types::PARAMETER_INTEGER);
  value.integer_value(v);
  return value;
}
ParameterValue number(double v) {
  auto value = of_type(types::PARAMETER_DOUBLE);
  value.double_value(v);
  return value;
}
ParameterValue text(const std::string& v) {
  auto value = of_type(types::PARAMETER_STRING);
  value.string_value(v);
  return value;
}
ParameterValue texts(const std::vector<std::string>& v) {
  auto value = of_type(types::PARAMETER_STRING_ARRAY);
  value.string_array_value(v);
  return value;
}
ParameterValue numbers(const std::vector<double>& v) {
  auto value = of_type(types::PARAMETER_DOUBLE_ARRAY);
  value.double_array_value(v);
  return value;
}

/// Every type of key: its value, and the same back from a parameter.
template <class Value>
void expect_round_trip(Value first, Value second, std::uint8_t type) {
  Value value = first;
  const ParameterValue parameter = to_value(key(value));
  EXPECT_EQ(parameter.type(), type);
  value = second;
  EXPECT_EQ(assign(key(value), parameter), "");
  EXPECT_EQ(value, first);
}

TEST(ParameterValue, HoldsEveryTypeOfKey) {
  expect_round_trip(true, false, types::PARAMETER_BOOL);
  expect_round_trip(-7, 8, types::PARAMETER_INTEGER);
  expect_round_trip(std::int64_t{1} << 40, std::int64_t{3}, types::PARAMETER_INTEGER);
  expect_round_trip(0.1, 2.5, types::PARAMETER_DOUBLE);
  expect_round_trip(std::string("a b"), std::string(), types::PARAMETER_STRING);
  expect_round_trip(config::Words{"a", "b"}, config::Words{}, types::PARAMETER_STRING_ARRAY);
  expect_round_trip(config::Numbers{0.5, 3.0}, config::Numbers{1.0}, types::PARAMETER_DOUBLE_ARRAY);
}

TEST(ParameterValue, IsRefusedWithTheReasonAndNothingChanges) {
  bool flag = true;
  int count = 5;
  std::int64_t seed = 1;
  double length = 2.0;
  std::string word = "fast";
  config::Words words = {"fast"};
  config::Numbers list = {1.0};
  const auto one_of = config::one_of({"fast", "exact"});
  const auto range = config::in_range(1, 10);
  EXPECT_EQ(assign(key(flag), integer(1)), "slam.key is a bool, not an integer");
  EXPECT_EQ(assign(key(count, range), number(2.0)), "slam.key is an integer, not a double");
  EXPECT_EQ(assign(key(count, range), integer(11)), "slam.key: 11 is out of range, allowed is 1 to 10");
  EXPECT_EQ(assign(key(count), integer(std::int64_t{1} << 31)),
            "slam.key: 2147483648 is out of range, allowed is -2147483648 to 2147483647");
  EXPECT_EQ(assign(key(seed, config::at_least(0)), integer(-1)), "slam.key: -1 is out of range, allowed is at least 0");
  EXPECT_EQ(assign(key(length, range), number(0.5)), "slam.key: 0.5 is out of range, allowed is 1 to 10");
  EXPECT_EQ(assign(key(length, range), boolean(true)), "slam.key is a double, not a bool");
  EXPECT_EQ(assign(key(length, range), text("2")), "slam.key is a double, not a string");
  EXPECT_NE(assign(key(length), number(std::numeric_limits<double>::quiet_NaN())), "");
  EXPECT_EQ(assign(key(word, one_of), text("slow")), "slam.key: \"slow\" is not one of fast | exact");
  EXPECT_EQ(assign(key(word), text("\xff")), "slam.key: \"\\u00ff\" is no UTF-8 text");
  EXPECT_EQ(assign(key(word), of_type(types::PARAMETER_NOT_SET)), "slam.key is a string, not none");
  EXPECT_EQ(assign(key(word), of_type(77)), "slam.key is a string, not of unknown type 77");
  EXPECT_EQ(assign(key(words, one_of), texts({"exact", "slow"})),
            "slam.key: [\"exact\", \"slow\"] is not one of fast | exact");
  EXPECT_EQ(assign(key(list, range), numbers({2.0, 11.0})), "slam.key: [2, 11] is out of range, allowed is 1 to 10");
  EXPECT_EQ(assign(key(list), text("1")), "slam.key is a list of doubles, not a string");
  EXPECT_TRUE(flag);
  EXPECT_EQ(count, 5);
  EXPECT_EQ(seed, 1);
  EXPECT_EQ(length, 2.0);
  EXPECT_EQ(word, "fast");
  EXPECT_THAT(words, ElementsAre("fast"));
  EXPECT_THAT(list, ElementsAre(1.0));
}

TEST(ParameterValue, AnIntegerIsADoubleToo) {
  double length = 2.0;
  EXPECT_EQ(assign(key(length), integer(3)), "");
  EXPECT_EQ(length, 3.0);
  config::Numbers list;
  auto integers = of_type(types::PARAMETER_INTEGER_ARRAY);
  integers.integer_array_value({4, 5});
  EXPECT_EQ(assign(key(list), integers), "");
  EXPECT_THAT(list, ElementsAre(4.0, 5.0));
}

TEST(ParameterDescriptor, HasNameTypeMeaningAndWhetherItIsReadAtStart) {
  bool flag = true;
  config::Entry entry = key(flag);
  auto descriptor = to_descriptor(entry);
  EXPECT_EQ(descriptor.name(), "slam.key");
  EXPECT_EQ(descriptor.type(), types::PARAMETER_BOOL);
  EXPECT_EQ(descriptor.description(), "what it is");
  EXPECT_FALSE(descriptor.read_only());
  EXPECT_FALSE(descriptor.dynamic_typing());
  EXPECT_THAT(descriptor.integer_range(), IsEmpty());
  EXPECT_THAT(descriptor.floating_point_range(), IsEmpty());
  entry.change = config::Change::kAtStart;
  EXPECT_TRUE(to_descriptor(entry).read_only());
}

TEST(ParameterDescriptor, HasTheBoundsAsRangesOrAsText) {
  double length = 1.0;
  auto descriptor = to_descriptor(key(length, config::in_range(0.1, 20.0)));
  ASSERT_EQ(descriptor.floating_point_range().size(), 1U);
  EXPECT_EQ(descriptor.floating_point_range()[0].from_value(), 0.1);
  EXPECT_EQ(descriptor.floating_point_range()[0].to_value(), 20.0);
  EXPECT_EQ(descriptor.floating_point_range()[0].step(), 0.0);
  descriptor = to_descriptor(key(length, config::at_least(3.0)));
  ASSERT_EQ(descriptor.floating_point_range().size(), 1U);
  EXPECT_EQ(descriptor.floating_point_range()[0].to_value(), kInfinity);
  EXPECT_THAT(to_descriptor(key(length)).floating_point_range(), IsEmpty());

  int count = 1;
  descriptor = to_descriptor(key(count, config::in_range(0.5, 20.5)));
  ASSERT_EQ(descriptor.integer_range().size(), 1U);
  EXPECT_EQ(descriptor.integer_range()[0].from_value(), 1);
  EXPECT_EQ(descriptor.integer_range()[0].to_value(), 20);
  descriptor = to_descriptor(key(count));
  EXPECT_EQ(descriptor.integer_range()[0].from_value(), std::numeric_limits<int>::lowest());
  EXPECT_EQ(descriptor.integer_range()[0].to_value(), std::numeric_limits<int>::max());
  std::int64_t seed = 1;
  descriptor = to_descriptor(key(seed, config::at_least(0)));
  EXPECT_EQ(descriptor.integer_range()[0].from_value(), 0);
  EXPECT_EQ(descriptor.integer_range()[0].to_value(), std::numeric_limits<std::int64_t>::max());
  EXPECT_THAT(to_descriptor(key(seed)).integer_range(), IsEmpty());

  std::string word = "fast";
  EXPECT_EQ(to_descriptor(key(word, config::one_of({"fast", "exact"}))).additional_constraints(), "fast | exact");
  config::Numbers list = {1.0};
  EXPECT_EQ(to_descriptor(key(list, config::in_range(0, 2))).additional_constraints(), "0 to 2");
  EXPECT_EQ(to_descriptor(key(list)).additional_constraints(), "");
}

}  // namespace
}  // namespace lapis::parameters
