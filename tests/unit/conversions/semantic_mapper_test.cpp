#include "semantic_mapper/conversions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::semantic_mapper {
namespace {

using ::testing::HasSubstr;

sensor_msgs::msg::Image depth_image(std::uint32_t width, std::uint32_t height, std::uint16_t millimetres) {
  sensor_msgs::msg::Image message;
  message.width(width);
  message.height(height);
  message.encoding("16UC1");
  message.step(width * 2);
  for (std::uint32_t i = 0; i < width * height; ++i) {
    message.data().push_back(static_cast<std::uint8_t>(millimetres & 255));
    message.data().push_back(static_cast<std::uint8_t>(millimetres >> 8));
  }
  return message;
}

/// Class 3 everywhere.
sensor_msgs::msg::Image label_image(std::uint32_t width, std::uint32_t height) {
  auto message = depth_image(width, height, 3);
  message.encoding("mono16");
  return message;
}

sensor_msgs::msg::CameraInfo camera_info(std::uint32_t width, std::uint32_t height) {
  sensor_msgs::msg::CameraInfo info;
  info.width(width);
  info.height(height);
  info.k({8.0, 0.0, 3.5, 0.0, 8.0, 2.5, 0.0, 0.0, 1.0});
  return info;
}

lapis_msgs::msg::TrackedFrame tracked_frame() {
  lapis_msgs::msg::TrackedFrame message;
  message.header().stamp(messages::to_message(time::Time{42}));
  message.keyframe_id(5);
  message.graph_version(6);
  message.keyframe_pose(messages::to_message(geometry::Pose::Identity()));
  message.pose_in_keyframe(messages::to_message(geometry::Pose::Identity()));
  return message;
}

messages::Converted<mapping::CompactFrame> compact(const sensor_msgs::msg::CameraInfo& info,
                                                   const sensor_msgs::msg::Image* labels = nullptr,
                                                   const sensor_msgs::msg::Image* confidence = nullptr) {
  using Result = messages::Converted<mapping::CompactFrame>;
  images::KeptRectifier rectifier;
  mapping::CompactFrameConfig every_pixel;
  every_pixel.stride = 1;
  const auto camera = messages::lens_camera(info);
  if (!camera) return Result::refused(camera.reason);
  auto frame = to_core(geometry::DepthImage(8, 6, 1.0F), *camera, every_pixel);
  if (!frame) return frame;
  const std::string problem = set_labels(*frame, {labels, confidence}, *camera, every_pixel, rectifier);
  return problem.empty() ? std::move(frame) : Result::refused(problem);
}
mapping::CompactFrame compact_frame() { return *compact(camera_info(8, 6)); }

TEST(SemanticMapperConversions, DepthWithoutLabelsIsAFrameWithoutLabels) {
  const auto frame = compact(camera_info(8, 6));
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->has_labels());
  EXPECT_DOUBLE_EQ(frame->median_depth_m(), 1.0);
}

TEST(SemanticMapperConversions, SizesThatDisagreeAreRefused) {
  EXPECT_FALSE(compact(camera_info(4, 6)));
  const auto labels = label_image(4, 6);
  EXPECT_THAT(compact(camera_info(8, 6), &labels).reason, HasSubstr("label image is 4x6, camera info says 8x6"));
  const auto whole = label_image(8, 6);
  auto confidence = label_image(8, 5);
  confidence.encoding("mono8");
  confidence.step(8);
  confidence.data().resize(40);
  EXPECT_THAT(compact(camera_info(8, 6), &whole, &confidence).reason, HasSubstr("confidence image is 8x5"));
}

TEST(SemanticMapperConversions, LensesThatNobodyKnowsAreRefusedWithTheReason) {
  auto info = camera_info(8, 6);
  info.distortion_model("equidistant");
  EXPECT_THAT(compact(info).reason, HasSubstr("distortion model 'equidistant'"));
}

// Depth has been rectified; labels come as the lens shows them. This lens shows the corners of the view outside of its
// image.
TEST(SemanticMapperConversions, LabelsOfALensAreRectified) {
  auto info = camera_info(8, 6);
  const auto labels = label_image(8, 6);
  const auto straight = compact(info, &labels);
  info.distortion_model("plumb_bob");
  info.d({1.0, 0.0, 0.0, 0.0, 0.0});
  const auto bent = compact(info, &labels);
  ASSERT_TRUE(straight && bent) << straight.reason << bent.reason;
  const auto unlabelled = [](const mapping::CompactFrame& frame) {
    return std::count(frame.labels().begin(), frame.labels().end(), 0);
  };
  EXPECT_EQ(unlabelled(*straight), 0);
  EXPECT_GE(unlabelled(*bent), 4);
  EXPECT_LT(unlabelled(*bent), 24);
}

TEST(SemanticMapperConversions, AnchorKeepsIdsAndStamp) {
  const auto anchored = to_core(tracked_frame(), compact_frame());
  ASSERT_TRUE(anchored);
  EXPECT_EQ(anchored->keyframe_id, 5u);
  EXPECT_EQ(anchored->graph_version, 6u);
  EXPECT_EQ(anchored->stamp, time::Time{42});
}

TEST(SemanticMapperConversions, InvalidPosesAreRefusedByName) {
  auto tracked = tracked_frame();
  tracked.pose_in_keyframe(geometry_msgs::msg::Pose());  // the all-zero quaternion of "unknown"
  EXPECT_THAT(to_core(tracked, compact_frame()).reason, HasSubstr("pose_in_keyframe"));
}

TEST(SemanticMapperConversions, PointCloudFieldsReadBack) {
  const LabelledPoint point{{1.0f, 2.0f, 3.0f}, {255, 128, 1}, 9, 0.75f};
  const auto message = to_message(std::vector{point}, std_msgs::msg::Header());
  ASSERT_EQ(message.width(), 1u);
  ASSERT_EQ(message.data().size(), message.point_step());
  for (const auto& field : message.fields()) {
    const auto* bytes = message.data().data() + field.offset();
    float number = 0.0f;
    std::uint32_t word = 0;
    std::uint16_t id = 0;
    if (field.name() == "label") {
      std::memcpy(&id, bytes, sizeof id);
      EXPECT_EQ(id, 9);
    } else if (field.name() == "rgb") {
      std::memcpy(&word, bytes, sizeof word);
      EXPECT_EQ(word, 0x00ff8001u);
    } else {
      std::memcpy(&number, bytes, sizeof number);
      const std::map<std::string, float> expected = {{"x", 1.0f}, {"y", 2.0f}, {"z", 3.0f}, {"probability", 0.75f}};
      EXPECT_EQ(number, expected.at(field.name()));
    }
  }
}

TEST(SemanticMapperConversions, OccupancyGridKeepsItsOriginAndCells) {
  OccupancyGrid grid{0.25, -1.0, 2.0, 2, 1, {100, -1}};
  const auto message = to_message(grid, std_msgs::msg::Header());
  EXPECT_FLOAT_EQ(message.info().resolution(), 0.25f);
  EXPECT_EQ(message.info().width(), 2u);
  EXPECT_EQ(message.info().origin().position().x(), -1.0);
  EXPECT_EQ(message.info().origin().orientation().w(), 1.0);
  EXPECT_EQ(message.data()[0], 100);
  EXPECT_EQ(message.data()[1], -1);
}

}  // namespace
}  // namespace lapis::semantic_mapper
