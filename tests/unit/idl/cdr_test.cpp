// Bytes on the wire, written by hand from the rules of XCDR1 (OMG DDSI-RTPS 10.2, CORBA 15.3): primitives are aligned
// to their own size counted from the byte after the encapsulation header; a string is uint32 length with NUL, bytes,
// NUL; a sequence is uint32 count and elements; an array is its elements.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <string>

#include "cdr.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/rcl_interfaces.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::idl::test {
namespace {

std_msgs::msg::Header make_header(std::int32_t sec, std::uint32_t nanosec, const std::string& frame_id) {
  std_msgs::msg::Header header;
  header.stamp().sec(sec);
  header.stamp().nanosec(nanosec);
  header.frame_id(frame_id);
  return header;
}

/// The message becomes these bytes, and these bytes become the message, also with the padding RTPS may add.
template <typename T>
void expect_wire(const T& message, const Bytes& bytes) {
  EXPECT_EQ(serialize(message), bytes);
  T read;
  ASSERT_TRUE(decode(bytes, read));
  EXPECT_TRUE(read == message);

  Bytes padded = bytes;
  padded.insert(padded.end(), 3, 0);
  T read_padded;
  ASSERT_TRUE(decode(padded, read_padded));
  EXPECT_TRUE(read_padded == message);
}

TEST(Cdr, String) {
  std_msgs::msg::String message;
  message.data("hello 2");
  expect_wire(message, {0, 1, 0, 0, 8, 0, 0, 0, 'h', 'e', 'l', 'l', 'o', ' ', '2', 0});
}

TEST(Cdr, EmptyStringHoldsItsNul) { expect_wire(std_msgs::msg::String(), {0, 1, 0, 0, 1, 0, 0, 0, 0}); }

TEST(Cdr, EmptyMessageIsOneByte) { expect_wire(std_msgs::msg::Empty(), {0, 1, 0, 0, 0}); }

TEST(Cdr, HeaderWithTimeBefore1970) {
  expect_wire(make_header(-2, 0x3b9ac9ff, "map"), {0,    1,    0,    0,     //
                                                   0xfe, 0xff, 0xff, 0xff,  // sec -2
                                                   0xff, 0xc9, 0x9a, 0x3b,  // nanosec 999999999
                                                   4,    0,    0,    0,    'm', 'a', 'p', 0});
}

TEST(Cdr, BigEndianIsRead) {
  std_msgs::msg::Header read;
  ASSERT_TRUE(decode(Bytes{0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 3, 0, 0, 0, 2, 'a', 0}, read));
  EXPECT_TRUE(read == make_header(258, 3, "a"));
}

sensor_msgs::msg::Image small_image() {
  sensor_msgs::msg::Image image;
  image.header(make_header(1, 2, "cam"));
  image.height(1);
  image.width(2);
  image.encoding("rgb8");
  image.is_bigendian(0);
  image.step(6);
  image.data({10, 20, 30, 40, 50, 255});
  return image;
}

TEST(Cdr, Image) {
  expect_wire(small_image(), {0, 1, 0, 0,                                 //
                              1, 0, 0, 0, 2,   0,   0,   0,               // stamp
                              4, 0, 0, 0, 'c', 'a', 'm', 0,               // frame_id
                              1, 0, 0, 0, 2,   0,   0,   0,               // height, width
                              5, 0, 0, 0, 'r', 'g', 'b', '8', 0,          // encoding: ends at 33
                              0, 0, 0,                                    // is_bigendian, padding to 36
                              6, 0, 0, 0,                                 // step
                              6, 0, 0, 0, 10,  20,  30,  40,  50, 255});  // data
}

TEST(Cdr, EmptySequencesAddNoPadding) {
  sensor_msgs::msg::JointState message;
  message.header(make_header(0, 0, ""));
  // 8 bytes of stamp, 5 of the empty string, 3 of padding, then four counts: no alignment to double follows a zero.
  expect_wire(message, {0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0,
                        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
}

void append_double(Bytes& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (unsigned shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
}

TEST(Cdr, OdometryAlignsDoublesToEight) {
  nav_msgs::msg::Odometry message;
  message.header(make_header(7, 8, "odom"));
  message.child_frame_id("base_link");
  auto& pose = message.pose().pose();
  pose.position().x(1.5);
  pose.position().y(-2.0);
  pose.position().z(0.25);
  pose.orientation().x(0.5);
  pose.orientation().y(-0.5);
  pose.orientation().z(0.5);
  pose.orientation().w(-0.5);
  auto& twist = message.twist().twist();
  twist.linear().x(10.0);
  twist.linear().y(11.0);
  twist.linear().z(12.0);
  twist.angular().x(13.0);
  twist.angular().y(14.0);
  twist.angular().z(15.0);
  for (std::size_t i = 0; i < 36; ++i) {
    message.pose().covariance()[i] = 100.0 + static_cast<double>(i);
    message.twist().covariance()[i] = 200.0 + static_cast<double>(i);
  }

  Bytes expected = {0,  1, 0, 0,                                                  //
                    7,  0, 0, 0, 8,   0,   0,   0,                                // stamp
                    5,  0, 0, 0, 'o', 'd', 'o', 'm', 0,                           // frame_id: ends at 17
                    0,  0, 0,                                                     // padding to 20
                    10, 0, 0, 0, 'b', 'a', 's', 'e', '_', 'l', 'i', 'n', 'k', 0,  // child_frame_id: ends at 34
                    0,  0, 0, 0, 0,   0};                                         // padding to 40
  for (const double value : {1.5, -2.0, 0.25, 0.5, -0.5, 0.5, -0.5}) append_double(expected, value);
  for (int i = 0; i < 36; ++i) append_double(expected, 100.0 + i);
  for (const double value : {10.0, 11.0, 12.0, 13.0, 14.0, 15.0}) append_double(expected, value);
  for (int i = 0; i < 36; ++i) append_double(expected, 200.0 + i);
  ASSERT_EQ(expected.size(), 4U + 40U + 85U * 8U);
  expect_wire(message, expected);
}

TEST(Cdr, TruncatedBytesAreNoMessage) {
  const Bytes bytes = serialize(small_image());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    sensor_msgs::msg::Image read;
    EXPECT_FALSE(decode(std::span(bytes).first(size), read)) << size;
  }
}

TEST(Cdr, MemoryThatIsTooSmallIsNotWrittenBeyondItsEnd) {
  const Bytes bytes = serialize(small_image());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Bytes memory(bytes.size(), 0xAB);
    EXPECT_EQ(encode(small_image(), std::span(memory).first(size)), 0U);
    EXPECT_TRUE(std::all_of(memory.begin() + static_cast<std::ptrdiff_t>(size), memory.end(),
                            [](std::uint8_t byte) { return byte == 0xAB; }));
  }
}

TEST(Cdr, BooleansAndBoundedSequences) {
  rcl_interfaces::msg::ParameterValue value;
  value.bool_array_value({true, false, true});
  rcl_interfaces::msg::ParameterValue read;
  Bytes bytes = serialize(value);
  ASSERT_TRUE(decode(bytes, read));
  EXPECT_TRUE(read == value);

  rcl_interfaces::msg::ParameterDescriptor descriptor;  // holds at most one range
  descriptor.integer_range().resize(1);
  EXPECT_TRUE(decode(serialize(descriptor), descriptor));
  descriptor.integer_range().resize(2);
  EXPECT_FALSE(decode(serialize(descriptor), descriptor));
}

TEST(Cdr, CountBeyondTheBytesIsRefused) {
  Bytes bytes = serialize(small_image());
  const std::size_t count = bytes.size() - 6 - 4;
  for (std::size_t i = 0; i < 4; ++i) bytes[count + i] = 0xff;
  sensor_msgs::msg::Image read;
  EXPECT_FALSE(decode(bytes, read));
}

}  // namespace
}  // namespace lapis::idl::test
