#include "sensor_replay/conversions.hpp"

#include <gtest/gtest.h>

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::sensor_replay {
namespace {

const messages::CameraFrameIds kIds{"base_link", "camera_link", "camera_color_optical_frame",
                                    "camera_depth_optical_frame", "world"};

CameraFile camera_file() {
  CameraFile file;
  file.camera = {8, 6, 10.0, 11.0, 3.5, 2.5};
  file.mount = {1.0, 0.14};
  return file;
}

ReplayFrame frame() {
  ReplayFrame f;
  f.stamp = time::Time{1'500'000'000};
  f.color = geometry::ColorImage(8, 6, {10, 20, 30});
  f.depth = DepthMillimetres(8, 6, 1234);
  f.label = geometry::LabelImage(8, 6, 7);
  f.T_world_camera = T_base_camera(camera_file().mount);
  return f;
}

TEST(SensorReplayConversions, ConsumersReadBackWhatWasRecorded) {
  const auto out = to_messages(frame(), camera_file(), kIds);
  for (const auto& info : {out.color_info, out.depth_info}) {
    const auto camera = messages::lens_camera(info);
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->pinhole, camera_file().camera);
    EXPECT_FALSE(camera->is_distorted());
  }
  const auto depth = messages::to_depth(*out.depth);
  ASSERT_TRUE(depth);
  EXPECT_FLOAT_EQ((*depth)(5, 3), 1.234f);
  const auto labels = messages::to_labels(*out.labels);
  ASSERT_TRUE(labels);
  EXPECT_EQ((*labels)(0, 0), 7);
  EXPECT_EQ(out.labels->encoding(), "mono8");
  EXPECT_EQ(out.color.encoding(), "rgb8");
  EXPECT_EQ(out.color.data()[2], 30);
}

TEST(SensorReplayConversions, EveryMessageOfAFrameHasItsStamp) {
  const auto out = to_messages(frame(), camera_file(), kIds);
  for (const auto& header : {out.color.header(), out.color_info.header(), out.depth_info.header(), out.depth->header(),
                             out.labels->header()}) {
    EXPECT_EQ(messages::from_message(header.stamp()), time::Time{1'500'000'000});
    EXPECT_EQ(header.frame_id(), kIds.optical);
  }
  EXPECT_EQ(messages::from_message(out.ground_truth->header().stamp()), time::Time{1'500'000'000});
}

TEST(SensorReplayConversions, WideLabelIdsTakeSixteenBits) {
  auto wide = frame();
  (*wide.label)(2, 2) = 255;  // in 8 bits it would read as unlabelled
  const auto out = to_messages(wide, camera_file(), kIds);
  EXPECT_EQ(out.labels->encoding(), "mono16");
  const auto labels = messages::to_labels(*out.labels);
  ASSERT_TRUE(labels);
  EXPECT_EQ((*labels)(2, 2), 255);
}

TEST(SensorReplayConversions, MissingPartsAreNotPublished) {
  auto bare = frame();
  bare.depth.reset();
  bare.label.reset();
  bare.T_world_camera.reset();
  const auto out = to_messages(bare, camera_file(), kIds);
  EXPECT_FALSE(out.depth);
  EXPECT_FALSE(out.labels);
  EXPECT_FALSE(out.ground_truth);
}

TEST(SensorReplayConversions, StaticTransformsGiveTheMount) {
  messages::StaticTransforms transforms;
  transforms.add(messages::to_static_transforms(to_set_up(camera_file()), kIds, time::Time{}));
  const auto T = transforms.find("base_link", "camera_color_optical_frame");
  ASSERT_TRUE(T);
  EXPECT_TRUE(T->isApprox(T_base_camera(camera_file().mount), 1e-12));
}

TEST(SensorReplayConversions, ADepthCameraOfItsOwnHasItsFrameItsCalibrationAndItsMount) {
  auto file = camera_file();
  const auto T_color_depth =
      geometry::make_pose({0.025, 0.0, 0.001}, Eigen::Quaterniond(0.9998, 0.02, 0.0, 0.0).normalized());
  file.depth_camera = {{{16, 12, 21.0, 22.0, 7.0, 6.0}, {}}, T_color_depth};
  auto seen = frame();
  seen.depth = DepthMillimetres(16, 12, 1234);
  const auto out = to_messages(seen, file, kIds);
  EXPECT_EQ(out.depth->header().frame_id(), kIds.depth_optical);
  EXPECT_EQ(out.depth_info.header().frame_id(), kIds.depth_optical);
  EXPECT_EQ(out.color_info.header().frame_id(), kIds.optical);
  EXPECT_EQ(messages::lens_camera(out.depth_info)->pinhole, file.depth_camera->camera.pinhole);
  EXPECT_EQ(messages::lens_camera(out.color_info)->pinhole, file.camera);
  messages::StaticTransforms transforms;
  transforms.add(messages::to_static_transforms(to_set_up(file), kIds, time::Time{}));
  const auto T = transforms.find(kIds.optical, kIds.depth_optical);
  ASSERT_TRUE(T);
  EXPECT_TRUE(T->isApprox(T_color_depth, 1e-12));
}

TEST(SensorReplayConversions, GroundTruthIsThePoseOfTheBase) {
  const auto out = to_messages(frame(), camera_file(), kIds);  // the camera's true pose is its mount
  const auto T_world_base = messages::from_message(out.ground_truth->pose().pose());
  ASSERT_TRUE(T_world_base);
  EXPECT_TRUE(T_world_base->isApprox(geometry::Pose::Identity(), 1e-12));
}

}  // namespace
}  // namespace lapis::sensor_replay
