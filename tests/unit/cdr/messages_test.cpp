// Messages by their declarations against the types and the serialisation that fastddsgen makes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/cdr/decode.hpp"
#include "common/cdr/encode.hpp"
#include "common/topics.hpp"
#include "idl/rcl_interfaces.hpp"
#include "idl/type_table.hpp"
#include "tests/fuzz/message_types.hpp"
#include "tests/unit/idl/cdr.hpp"

namespace lapis::cdr {
namespace {

using ::testing::HasSubstr;

template <class Message>
Layout layout_of() {
  const idl::TypeEntry* entry = idl::find(idl::TypeSupport<Message>::kRosName);
  return parse_ros2msg(entry->ros_name, entry->ros2msg_text);
}

/// Messages of any layout, with numbers that are not zero, lists of 0 to 3 elements and texts of any length.
class RandomMessages {
 public:
  explicit RandomMessages(const Layout& layout) : layout_(layout) {}

  Value structure(std::size_t index) {
    Value value = Value::object();
    for (const Field& field : layout_.structures[index].fields) value[field.name] = member(field);
    return value;
  }

 private:
  Value member(const Field& field) {
    if (field.container == Container::kNone) return element(field);
    std::size_t count = field.container == Container::kArray ? field.capacity : random_() % 4;
    if (field.container == Container::kSequence && field.capacity > 0) count = std::min(count, field.capacity);
    Value value = Value::array();
    for (std::size_t i = 0; i < count; ++i) value.push_back(element(field));
    return value;
  }
  Value element(const Field& field) {
    switch (field.kind) {
      case Kind::kBool: return random_() % 2 == 0;
      case Kind::kByte:
      case Kind::kUint8: return static_cast<std::uint8_t>(random_());
      case Kind::kInt8: return static_cast<std::int8_t>(random_());
      case Kind::kInt16: return static_cast<std::int16_t>(random_());
      case Kind::kUint16: return static_cast<std::uint16_t>(random_());
      case Kind::kInt32: return static_cast<std::int32_t>(random_());
      case Kind::kUint32: return static_cast<std::uint32_t>(random_());
      case Kind::kInt64: return static_cast<std::int64_t>(random_());
      case Kind::kUint64: return static_cast<std::uint64_t>(random_());
      case Kind::kFloat32: return 0.25 * static_cast<double>(random_() % 1000);
      case Kind::kFloat64: return 1e-3 * static_cast<double>(static_cast<std::int64_t>(random_()));
      case Kind::kString: return std::string(random_() % 9, 'x');
      case Kind::kStructure: return structure(field.structure);
    }
    return {};
  }

  const Layout& layout_;
  std::mt19937_64 random_{7};
};

template <class Message>
void expect_the_bytes_of_fastddsgen() {
  const Layout layout = layout_of<Message>();
  RandomMessages random(layout);
  for (int i = 0; i < 20; ++i) {
    const Value value = random.structure(0);
    const Bytes bytes = encode(layout, value);
    Message message;
    ASSERT_TRUE(idl::test::deserialize(bytes, message)) << idl::TypeSupport<Message>::kRosName;
    ASSERT_EQ(idl::test::serialize(message), bytes) << idl::TypeSupport<Message>::kRosName;
    ASSERT_EQ(decode(layout, bytes), value) << idl::TypeSupport<Message>::kRosName;
  }
}

TEST(CdrMessages, AreThoseOfFastddsgen) {
  fuzz::for_each_message([]<class Message>(std::type_identity<Message>) { expect_the_bytes_of_fastddsgen<Message>(); });
  expect_the_bytes_of_fastddsgen<rcl_interfaces::srv::SetParameters_Request>();
  expect_the_bytes_of_fastddsgen<rcl_interfaces::srv::DescribeParameters_Response>();
}

TEST(CdrMessages, HaveTheFieldsOfTheirType) {
  nav_msgs::msg::Odometry message;
  message.header().stamp().sec(-3);
  message.header().frame_id("map");
  message.pose().pose().position().x(1.5);
  message.pose().covariance()[35] = 0.25;
  const Value value = decode(layout_of<nav_msgs::msg::Odometry>(), idl::test::serialize(message));
  EXPECT_EQ(value["header"]["stamp"]["sec"], -3);
  EXPECT_EQ(value["header"]["frame_id"], "map");
  EXPECT_EQ(value["pose"]["pose"]["position"]["x"], 1.5);
  EXPECT_EQ(value["pose"]["covariance"].size(), 36U);
  EXPECT_EQ(value["pose"]["covariance"][35], 0.25);
}

TEST(CdrMessages, KeepNumbersThatAreNone) {
  const Layout layout = layout_of<geometry_msgs::msg::Point>();
  const Value value = decode(layout, encode(layout, {{"x", ".nan"}, {"y", "-.inf"}, {"z", "+2"}}));
  EXPECT_TRUE(std::isnan(value["x"].get<double>()));
  EXPECT_EQ(value["y"], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(value["z"], 2.0);
}

TEST(CdrMessages, ShowFloatsAsTheyWereWritten) {
  const Layout layout = parse_ros2msg("a_msgs/msg/Single", "float32 value\n");
  EXPECT_EQ(decode(layout, encode(layout, {{"value", 0.1}}))["value"].dump(), "0.1");
}

TEST(CdrMessages, AreReadInEitherByteOrder) {
  const Layout layout = parse_ros2msg("a_msgs/msg/Mixed", "uint8 small\nuint32 large\nstring text\n");
  EXPECT_EQ(decode(layout, {0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 2, 'a', 0}),
            (Value{{"small", 7}, {"large", 258}, {"text", "a"}}));
}

TEST(CdrMessages, WithoutFieldsAreOneByte) {
  const Layout layout = parse_ros2msg("std_msgs/msg/Empty", "");
  EXPECT_EQ(encode(layout, {}), (Bytes{0, 1, 0, 0, 0}));
  EXPECT_EQ(decode(layout, {0, 1, 0, 0, 0}), Value::object());
}

TEST(CdrMessages, AreRefusedWhereBytesAreMissing) {
  const Layout layout = layout_of<sensor_msgs::msg::CameraInfo>();
  const Bytes whole = idl::test::serialize(sensor_msgs::msg::CameraInfo());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(decode(layout, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
                 std::runtime_error)
        << size;
  }
  EXPECT_NO_THROW(decode(layout, whole));
}

TEST(CdrMessages, OfAnyBytesAreReadOrRefused) {
  std::mt19937 random(3);
  fuzz::for_each_message([&]<class Message>(std::type_identity<Message>) {
    const Layout layout = layout_of<Message>();
    for (int i = 0; i < 200; ++i) {
      Bytes bytes{0, 1, 0, 0};
      for (std::size_t k = random() % 200; k > 0; --k) {
        bytes.push_back(static_cast<std::uint8_t>(random() % 4 == 0 ? random() : 0));
      }
      try {
        const Value value = decode(layout, bytes);
        EXPECT_EQ(decode(layout, encode(layout, value)).size(), value.size());
      } catch (const std::runtime_error&) {
      }
    }
  });
}

std::string refusal(const std::string& declaration, const Value& value) {
  try {
    encode(parse_ros2msg("a_msgs/msg/Tested", declaration), value);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CdrRequests, ThatDoNotFitNameTheField) {
  EXPECT_THAT(refusal("uint8 a\n", {{"a", 256}}), HasSubstr("a: an integer from 0 to 255 is wanted, not 256"));
  EXPECT_THAT(refusal("uint8 a\n", {{"a", -1}}), HasSubstr("from 0 to 255"));
  EXPECT_THAT(refusal("int8 a\n", {{"a", "x"}}), HasSubstr("from -128 to 127 is wanted, not \"x\""));
  EXPECT_THAT(refusal("int64 a\n", {{"a", 1.5}}), HasSubstr("an integer"));
  EXPECT_THAT(refusal("float32 a\n", {{"a", 1e39}}), HasSubstr("single precision"));
  EXPECT_THAT(refusal("float64 a\n", {{"a", "one"}}), HasSubstr("a number"));
  EXPECT_THAT(refusal("bool a\n", {{"a", 1}}), HasSubstr("true or false"));
  EXPECT_THAT(refusal("string<=2 a\n", {{"a", "abc"}}), HasSubstr("at most 2 bytes"));
  EXPECT_THAT(refusal("string a\n", {{"a", Value::array()}}), HasSubstr("a text"));
  EXPECT_THAT(refusal("int32[2] a\n", {{"a", {1}}}), HasSubstr("a list of 2"));
  EXPECT_THAT(refusal("int32[<=2] a\n", {{"a", {1, 2, 3}}}), HasSubstr("at most 2"));
  EXPECT_THAT(refusal("int32[] a\n", {{"a", {1, "x"}}}), HasSubstr("a[1]"));
  EXPECT_THAT(refusal("int32 a\nint32 b\n", {{"c", 1}}), HasSubstr("has no field c; it has a, b"));
  EXPECT_THAT(refusal("int32 a\n", 5), HasSubstr("the message: {a} is wanted, not 5"));
  EXPECT_EQ(refusal("int32 a\nstring b\nbool c\n", {{"a", "7"}, {"b", 7}, {"c", "true"}}), "accepted");
}

}  // namespace
}  // namespace lapis::cdr
