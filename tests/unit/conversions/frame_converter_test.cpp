#include "slam/frame_converter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace lapis::slam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint32_t kWidth = 64, kHeight = 48;

sensor_msgs::msg::Image image(std::uint32_t width, std::uint32_t height, const std::string& encoding,
                              std::uint32_t bytes_per_pixel) {
  sensor_msgs::msg::Image message;
  message.width(width);
  message.height(height);
  message.encoding(encoding);
  message.step(width * bytes_per_pixel);
  message.data().resize(static_cast<std::size_t>(message.step()) * height);
  return message;
}

geometry::DepthImage depth() { return geometry::DepthImage(kWidth, kHeight, 1.0F); }

sensor_msgs::msg::CameraInfo camera_info(std::uint32_t width = kWidth, std::uint32_t height = kHeight) {
  sensor_msgs::msg::CameraInfo info;
  info.width(width);
  info.height(height);
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  info.k({100.0, 0.0, 31.5, 0.0, 100.0, 23.5, 0.0, 0.0, 1.0});
  return info;
}

/// Grey ramp to the right.
sensor_msgs::msg::Image ramp() {
  auto message = image(kWidth, kHeight, "mono8", 1);
  for (std::size_t i = 0; i < message.data().size(); ++i)
    message.data()[i] = static_cast<std::uint8_t>(3 * (i % kWidth));
  return message;
}

sensor_msgs::msg::CompressedImage compressed(sensor_msgs::msg::Image raw, const std::string& extension) {
  const cv::Mat pixels(static_cast<int>(raw.height()), static_cast<int>(raw.width()), CV_8UC1, raw.data().data());
  sensor_msgs::msg::CompressedImage message;
  cv::imencode(extension, pixels, message.data());
  return message;
}

TEST(FrameConverter, FrameKeepsStampCameraAndSizes) {
  FrameConverter converter;
  const auto frame = converter.convert(image(kWidth, kHeight, "rgb8", 3), depth(), camera_info(), time::Time{5});
  ASSERT_TRUE(frame) << frame.reason;
  EXPECT_EQ(frame->stamp, time::Time{5});
  EXPECT_EQ(frame->camera, (geometry::PinholeCamera{kWidth, kHeight, 100.0, 100.0, 31.5, 23.5}));
  EXPECT_EQ(frame->gray.height, 48);
  EXPECT_EQ(frame->depth.width, 64);
}

TEST(FrameConverter, DisagreeingSizesAreRefusedWithBoth) {
  FrameConverter converter;
  const auto color = converter.convert(ramp(), geometry::DepthImage(32, 24), camera_info(32, 24), {});
  EXPECT_THAT(color.reason, AllOf(HasSubstr("colour image is 64x48"), HasSubstr("32x24")));
}

TEST(FrameConverter, CompressedColorIsTheSameImage) {
  FrameConverter converter;
  const auto raw = converter.convert(ramp(), depth(), camera_info(), {});
  const auto png = converter.convert(compressed(ramp(), ".png"), depth(), camera_info(), {});
  const auto jpeg = converter.convert(compressed(ramp(), ".jpg"), depth(), camera_info(), {});
  ASSERT_TRUE(raw && png && jpeg) << png.reason << jpeg.reason;
  EXPECT_EQ(png->gray.pixels, raw->gray.pixels);
  for (std::size_t i = 0; i < raw->gray.pixels.size(); ++i)
    ASSERT_NEAR(jpeg->gray.pixels[i], raw->gray.pixels[i], 4) << i;
}

TEST(FrameConverter, CompressedColorThatIsNoImageIsRefused) {
  FrameConverter converter;
  auto message = compressed(ramp(), ".jpg");
  EXPECT_THAT(converter.convert(message, geometry::DepthImage(32, 24), camera_info(32, 24), {}).reason,
              HasSubstr("compressed colour image is 64x48, camera info says 32x24"));
  message.data().resize(message.data().size() / 2);
  EXPECT_THAT(converter.convert(message, depth(), camera_info(), {}).reason, HasSubstr("damaged"));
  message.data().assign(1000, 0x55);
  EXPECT_THAT(converter.convert(message, depth(), camera_info(), {}).reason, HasSubstr("neither JPEG nor PNG"));
  message.data().clear();
  EXPECT_FALSE(converter.convert(message, depth(), camera_info(), {}));
}

// The radial model of the camera info pulls pixels of the right edge inwards; a ramp shows from where.
TEST(FrameConverter, DistortionIsTakenOutOfColorByTheCalibrationOfTheFrame) {
  FrameConverter converter;
  const auto expect_source = [&](double k1) {
    auto info = camera_info();
    info.d({k1, 0.0, 0.0, 0.0});
    const auto frame = converter.convert(ramp(), depth(), info, {});
    ASSERT_TRUE(frame) << frame.reason;
    constexpr int u = 55, v = 24;
    const double x = (u - 31.5) / 100.0, y = (v - 23.5) / 100.0;
    const double source = 31.5 + 100.0 * x * (1.0 + k1 * (x * x + y * y));
    EXPECT_NEAR(frame->gray(u, v), 3.0 * source, 1.0) << k1;
    EXPECT_EQ(frame->depth.pixels, depth().pixels) << "is rectified before";
    EXPECT_EQ(frame->camera.fx, 100.0);
  };
  expect_source(-1.0);
  expect_source(0.8);
  expect_source(0.0);
}

TEST(FrameConverter, UnknownDistortionIsRefusedWithTopicAndModel) {
  FrameConverter converter;
  auto info = camera_info();
  info.distortion_model("equidistant");
  EXPECT_THAT(converter.convert(ramp(), depth(), info, {}).reason,
              AllOf(HasSubstr("/camera/color/camera_info"), HasSubstr("equidistant")));
}

TEST(FrameConverter, DistortionWithoutMeasureGivesAnEmptyFrameNotACrash) {
  FrameConverter converter;
  auto info = camera_info();
  info.d({1e300, -1e300, 1e300, 1e300, -1e300});
  const auto frame = converter.convert(ramp(), depth(), info, {});
  ASSERT_TRUE(frame);
  EXPECT_THAT(frame->gray.pixels, ::testing::Each(0));
}

}  // namespace
}  // namespace lapis::slam
