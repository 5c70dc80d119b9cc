#include "common/messages/depth_converter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/camera.hpp"

namespace lapis::messages {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint32_t kColumns = 64, kLines = 48;

sensor_msgs::msg::CameraInfo calibration(const std::string& frame, double focal_px) {
  sensor_msgs::msg::CameraInfo info;
  info.header().frame_id(frame);
  info.width(kColumns);
  info.height(kLines);
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  info.k({focal_px, 0.0, 31.5, 0.0, focal_px, 23.5, 0.0, 0.0, 1.0});
  return info;
}

/// 1 m, but 1 mm more from column to column.
sensor_msgs::msg::Image ramp_of_depth(const std::string& frame) {
  sensor_msgs::msg::Image message;
  message.header().frame_id(frame);
  message.width(kColumns);
  message.height(kLines);
  message.encoding("16UC1");
  message.step(2 * kColumns);
  for (std::uint32_t i = 0; i < kColumns * kLines; ++i) {
    const std::uint32_t millimetres = 1000 + i % kColumns;
    message.data().push_back(static_cast<std::uint8_t>(millimetres & 255U));
    message.data().push_back(static_cast<std::uint8_t>(millimetres >> 8U));
  }
  return message;
}

tf2_msgs::msg::TFMessage mounts() {
  tf2_msgs::msg::TFMessage message;
  for (const auto& [child, x] : {std::pair("color", 0.0), std::pair("depth", 0.1)}) {
    geometry_msgs::msg::TransformStamped link;
    link.header().frame_id("camera_link");
    link.child_frame_id(child);
    link.transform().translation().x(x);
    link.transform().rotation().w(1.0);
    message.transforms().push_back(link);
  }
  return message;
}

TEST(DepthConverter, DepthOfTheColourFrameWithoutACameraInfoIsRegistered) {
  const StaticTransforms none;
  DepthConverter converter(none);
  const auto depth = converter.convert(ramp_of_depth("color"), calibration("color", 100.0));
  ASSERT_TRUE(depth) << depth.reason;
  EXPECT_EQ(depth->pixels, to_depth(ramp_of_depth("color"))->pixels);
  EXPECT_TRUE(converter.convert(ramp_of_depth("depth"), calibration("", 100.0))) << "a colour info that has no frame";
}

// The radial model pulls pixels of the right edge inwards; the ramp shows from where.
TEST(DepthConverter, TheLensIsThatOfColourUnlessDepthHasItsOwn) {
  const StaticTransforms none;
  DepthConverter converter(none);
  auto lens = calibration("color", 100.0);
  const auto expect_source = [&](double k1) {
    const auto depth = converter.convert(ramp_of_depth("color"), lens);
    ASSERT_TRUE(depth) << depth.reason;
    constexpr int u = 55, v = 24;
    const double x = (u - 31.5) / 100.0, y = (v - 23.5) / 100.0;
    const double source = 31.5 + 100.0 * x * (1.0 + k1 * (x * x + y * y));
    EXPECT_NEAR((*depth)(u, v), 1.0 + 0.001 * source, 0.00055) << k1;
  };
  for (const double k1 : {-1.0, 0.8, 0.0}) {
    lens.d({k1, 0.0, 0.0, 0.0});
    expect_source(k1);
  }
  converter.set_info(calibration("color", 100.0));
  lens.d({-1.0, 0.0, 0.0, 0.0});
  expect_source(0.0);
}

TEST(DepthConverter, DepthOfAnotherFrameIsSeenFromTheColourCamera) {
  StaticTransforms transforms;
  DepthConverter converter(transforms);
  converter.set_info(calibration("depth", 80.0));
  const auto color = calibration("color", 100.0);
  EXPECT_THAT(converter.convert(ramp_of_depth("depth"), color).reason, HasSubstr("/tf_static"));
  transforms.add(mounts());
  const auto depth = converter.convert(ramp_of_depth("depth"), color);
  ASSERT_TRUE(depth) << depth.reason;
  // The depth camera's column 25 sees x = 0.1 + (25 - 31.5) / 80 * z, which is in this column of the colour camera.
  const double z = 1.025, column = 31.5 + 100.0 * (0.1 + (25.0 - 31.5) / 80.0 * z) / z;
  EXPECT_NEAR((*depth)(static_cast<int>(std::lround(column)), 24), z, 0.0011);
  EXPECT_EQ((*depth)(0, 24), 0.0F) << "to the left of what the depth camera sees";
}

TEST(DepthConverter, AnEstimateCountsFromItsStampOn) {
  StaticTransforms none;
  DepthConverter converter(none);
  auto color = calibration("color", 100.0);
  images::RgbdCalibration cameras{{{64, 48, 100.0, 100.0, 31.5, 23.5}, {}},
                                  {{64, 48, 80.0, 81.0, 30.0, 22.0}, {0.1, 0.0, 0.0, 0.0}}};
  cameras.T_color_depth =
      geometry::make_pose({-0.03, 0.01, 0.002}, Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())));
  const auto header_at = [](int second) {
    std_msgs::msg::Header header;
    header.stamp().sec(second);
    return header;
  };
  EXPECT_FALSE(converter.has_estimate());
  EXPECT_EQ(converter.set_estimate(to_depth_info(header_at(5), cameras)), "");
  const images::RgbdCalibration first = cameras;
  cameras.depth.pinhole.fx = 90.0;
  EXPECT_EQ(converter.set_estimate(to_depth_info(header_at(7), cameras)), "");
  for (const auto& [second, expected] :
       {std::pair(1, first), std::pair(5, first), std::pair(6, first), std::pair(7, cameras), std::pair(9, cameras)}) {
    color.header(header_at(second));
    ASSERT_TRUE(converter.convert(ramp_of_depth("color"), color));
    EXPECT_EQ(converter.used()->depth, expected.depth) << second;
    EXPECT_TRUE(converter.used()->T_color_depth.isApprox(expected.T_color_depth, 1e-12)) << second;
  }
}

TEST(DepthConverter, AnEstimateHasTheFocalLengthOfColour) {
  StaticTransforms none;
  DepthConverter converter(none);
  const auto color = calibration("color", 100.0);
  images::RgbdCalibration cameras{{{64, 48, 97.0, 98.0, 31.5, 23.5}, {}}, {{64, 48, 80.0, 80.0, 31.5, 23.5}, {}}};
  cameras.T_color_depth.translation() = Eigen::Vector3d(-0.03, 0.01, 0.0);
  EXPECT_EQ(converter.corrected(color).k(), color.k());
  EXPECT_EQ(converter.set_estimate(to_depth_info({}, cameras)), "");
  ASSERT_TRUE(converter.convert(ramp_of_depth("color"), color));
  EXPECT_EQ(converter.used()->color.pinhole, cameras.color.pinhole);
  EXPECT_EQ(converter.corrected(color).k()[0], 97.0);
  EXPECT_EQ(converter.corrected(color).k()[4], 98.0);
}

TEST(DepthConverter, AnEstimateEndsWhenWhatIsGivenChanges) {
  StaticTransforms none;
  DepthConverter converter(none);
  auto color = calibration("color", 100.0);
  images::RgbdCalibration cameras{{{64, 48, 100.0, 100.0, 31.5, 23.5}, {}}, {{64, 48, 80.0, 80.0, 31.5, 23.5}, {}}};
  std_msgs::msg::Header header;
  converter.set_estimate(to_depth_info(header, cameras));
  ASSERT_TRUE(converter.convert(ramp_of_depth("color"), color));
  EXPECT_EQ(converter.used()->depth.pinhole.fx, 80.0);
  header.stamp().sec(5);
  cameras.depth.pinhole.fx = 85.0;
  converter.set_estimate(to_depth_info(header, cameras));  // by somebody who knows already
  color = calibration("color", 101.0);
  color.header().stamp().sec(5);
  ASSERT_TRUE(converter.convert(ramp_of_depth("color"), color));
  EXPECT_EQ(converter.used()->depth.pinhole.fx, 85.0);
  color = calibration("color", 102.0);
  color.header().stamp().sec(6);
  ASSERT_TRUE(converter.convert(ramp_of_depth("color"), color));
  EXPECT_FALSE(converter.has_estimate());
  EXPECT_EQ(converter.used()->depth.pinhole.fx, 102.0);
}

TEST(DepthConverter, AnEstimateOfAnotherSizeEnds) {
  StaticTransforms none;
  DepthConverter converter(none);
  const images::RgbdCalibration cameras{{{64, 48, 100.0, 100.0, 31.5, 23.5}, {}},
                                        {{32, 24, 50.0, 50.0, 15.5, 11.5}, {}}};
  EXPECT_EQ(converter.set_estimate(to_depth_info({}, cameras)), "");
  EXPECT_TRUE(converter.convert(ramp_of_depth("color"), calibration("color", 100.0)));
  EXPECT_FALSE(converter.has_estimate());
}

TEST(DepthConverter, AnEstimateThatIsNotOfAPairOfCamerasIsRefused) {
  StaticTransforms none;
  DepthConverter converter(none);
  EXPECT_THAT(converter.set_estimate(calibration("color", 100.0)), HasSubstr("pair of cameras"));
  EXPECT_THAT(converter.set_estimate(calibration("color", 0.0)), HasSubstr("focal length"));
  EXPECT_FALSE(converter.has_estimate());
}

TEST(DepthConverter, WhatDoesNotFitIsRefusedWithWhatToLookAt) {
  const StaticTransforms none;
  DepthConverter converter(none);
  EXPECT_THAT(converter.convert(ramp_of_depth("depth"), calibration("color", 100.0)).reason,
              AllOf(HasSubstr("/camera/color/camera_info"), HasSubstr("/camera/depth/camera_info")));
  auto info = calibration("color", 100.0);
  info.width(32);
  EXPECT_THAT(converter.convert(ramp_of_depth("color"), info).reason,
              HasSubstr("depth image is 64x48, camera info says 32x48"));
  info.distortion_model("equidistant");
  EXPECT_THAT(converter.convert(ramp_of_depth("color"), info).reason,
              AllOf(HasSubstr("/camera/color/camera_info: "), HasSubstr("equidistant")));
  converter.set_info(calibration("color", 1e-300));
  EXPECT_THAT(converter.convert(ramp_of_depth("color"), calibration("color", 100.0)).reason, HasSubstr("more than 16"));
  auto huge = calibration("color", 100.0);
  huge.width(16384);
  converter.set_info(calibration("color", 100.0));
  EXPECT_THAT(converter.convert(ramp_of_depth("color"), huge).reason, HasSubstr("more than 16"));
  converter.set_info(info);
  EXPECT_THAT(converter.convert(ramp_of_depth("color"), calibration("color", 100.0)).reason,
              AllOf(HasSubstr("/camera/depth/camera_info: "), HasSubstr("equidistant")));
}

}  // namespace
}  // namespace lapis::messages
