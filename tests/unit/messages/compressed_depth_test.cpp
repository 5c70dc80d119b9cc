#include "common/messages/compressed_depth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "common/messages/camera.hpp"

namespace lapis::messages {
namespace {

using sensor_msgs::msg::CompressedImage;
using ::testing::HasSubstr;

CompressedImage packed(const std::string& format, const cv::Mat& values, float a = 0.0f, float b = 0.0f) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", values, png);
  CompressedImage message;
  message.header().frame_id("depth_frame");
  message.header().stamp().sec(7);
  message.format(format);
  message.data().resize(12);
  std::memcpy(message.data().data() + 4, &a, sizeof a);
  std::memcpy(message.data().data() + 8, &b, sizeof b);
  message.data().insert(message.data().end(), png.begin(), png.end());
  return message;
}

cv::Mat ramp() {
  cv::Mat values(3, 4, CV_16UC1);
  for (int i = 0; i < 12; ++i) values.at<std::uint16_t>(i / 4, i % 4) = static_cast<std::uint16_t>(400 * i);
  return values;
}

TEST(CompressedDepth, MillimetresStayAsTheyAre) {
  for (const char* format : {"16UC1; compressedDepth", "16UC1; compressedDepth png"}) {
    const auto image = unpack_depth(packed(format, ramp()));
    ASSERT_TRUE(image) << image.reason;
    EXPECT_EQ(image->header().frame_id(), "depth_frame");
    EXPECT_EQ(image->header().stamp().sec(), 7);
    const auto depth = to_depth(*image);
    ASSERT_TRUE(depth) << depth.reason;
    ASSERT_EQ(depth->width, 4);
    ASSERT_EQ(depth->height, 3);
    for (std::size_t i = 0; i < 12; ++i) EXPECT_FLOAT_EQ(depth->pixels[i], 0.4f * static_cast<float>(i));
  }
}

/// As the publisher packs them: value = a / depth + b, with a = z0 (z0 + 1), b = 1 - a / z_max.
TEST(CompressedDepth, MetresComeBackWithinTheStepOfTheirPacking) {
  const float z0 = 100.0f, z_max = 10.0f;
  const float a = z0 * (z0 + 1.0f), b = 1.0f - a / z_max;
  const std::vector<float> truth = {0.5f, 1.0f, 2.5f, 5.0f, 9.9f, 0.0f};
  cv::Mat values(1, 6, CV_16UC1);
  for (int i = 0; i < 6; ++i) {
    const float z = truth[static_cast<std::size_t>(i)];
    values.at<std::uint16_t>(0, i) = static_cast<std::uint16_t>(z > 0.0f ? a / z + b : 0.0f);
  }
  const auto image = unpack_depth(packed("32FC1; compressedDepth png", values, a, b));
  ASSERT_TRUE(image) << image.reason;
  const auto depth = to_depth(*image);
  ASSERT_TRUE(depth) << depth.reason;
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(depth->pixels[i], truth[i], truth[i] * truth[i] / a + 1e-5f) << i;
}

TEST(CompressedDepth, RefusesWhatItCannotReadAndSaysWhy) {
  EXPECT_THAT(unpack_depth(packed("rgb8; jpeg compressed bgr8", ramp())).reason, HasSubstr("16UC1 or 32FC1"));
  EXPECT_THAT(unpack_depth(packed("16UC1; compressedDepth rvl", ramp())).reason, HasSubstr("set the driver to png"));
  CompressedImage message = packed("16UC1; compressedDepth png", ramp());
  message.data().erase(message.data().begin(), message.data().begin() + 12);
  EXPECT_THAT(unpack_depth(message).reason, HasSubstr("header of 12 bytes"));
  message.data().resize(5);
  EXPECT_THAT(unpack_depth(message).reason, HasSubstr("damaged"));
  message = packed("16UC1; compressedDepth png", ramp());
  message.data().resize(message.data().size() - 20);
  EXPECT_THAT(unpack_depth(message).reason, HasSubstr("damaged"));
  const cv::Mat bytes(3, 4, CV_8UC1, cv::Scalar(9));
  EXPECT_THAT(unpack_depth(packed("16UC1; compressedDepth png", bytes)).reason, HasSubstr("damaged"));
  EXPECT_THAT(unpack_depth(packed("16UC1; compressedDepth png", cv::Mat::zeros(6000, 6000, CV_16UC1))).reason,
              HasSubstr("2^25 pixels"));
}

TEST(CompressedDepth, WhateverBytesComeDepthIsUsableOrRefused) {
  std::mt19937 random(5);
  const CompressedImage whole = packed("32FC1; compressedDepth png", ramp(), 10100.0f, -1009.0f);
  for (int round = 0; round < 500; ++round) {
    CompressedImage message = whole;
    for (int change = 0; change < 3; ++change) {
      message.data()[random() % message.data().size()] = static_cast<std::uint8_t>(random());
    }
    const auto image = unpack_depth(message);
    if (!image) continue;
    const auto depth = to_depth(*image);
    ASSERT_TRUE(depth) << depth.reason;
    for (const float z : depth->pixels) ASSERT_TRUE(std::isfinite(z) && z >= 0.0f);
  }
}

}  // namespace
}  // namespace lapis::messages
