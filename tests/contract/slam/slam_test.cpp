// lapis_slam alone, fed with a synthetic camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <limits>

#include "common/topics/robot.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "tests/contract/slam/slam_contract.hpp"

namespace lapis::test {
namespace {

constexpr auto kInitializing = lapis_msgs::msg::TrackedFrame_Constants::STATE_INITIALIZING;

using nav_msgs::msg::Odometry;
using ::testing::HasSubstr;

TEST_F(SlamContract, TracksWithCopiedStampsRightFramesAndFiniteNumbers) {
  const auto& transforms = probe.collect(topics::kTransforms);
  ASSERT_TRUE(probe.wait_until_known_by("slam")) << slam.log();
  constexpr int kFrames = 15;
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(track(i)) << i << slam.log();
  ASSERT_TRUE(probe.wait_until([&] {
    return odometry.size() == kFrames && !transforms.empty() &&
           messages::from_message(transforms.back().transforms().at(0).header().stamp()) ==
               CameraFeed::stamp(kFrames - 1);
  }));
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  const auto T_map_first = *messages::from_message(odometry[0].pose().pose());
  for (int i = 0; i < kFrames; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(frames[at].state(), kTracking) << i << " " << frames[at].reason();
    EXPECT_EQ(frames[at].header().frame_id(), SyntheticCamera::kOpticalFrame);
    EXPECT_EQ(frames[at].map_frame_id(), "map");
    EXPECT_EQ(messages::from_message(odometry[at].header().stamp()), CameraFeed::stamp(i));
    EXPECT_EQ(odometry[at].header().frame_id(), "map");
    EXPECT_EQ(odometry[at].child_frame_id(), "base_link");
    ASSERT_TRUE(is_finite(odometry[at])) << i;
    EXPECT_GE(odometry[at].pose().covariance()[0], 0.0);
    // The camera's true motion, seen from the base.
    const auto T_camera = slow_motion(0).inverse() * slow_motion(i);
    const auto T_expected = T_base_camera() * T_camera * T_base_camera().inverse();
    const auto T_base = T_map_first.inverse() * *messages::from_message(odometry[at].pose().pose());
    EXPECT_LT((T_base.translation() - T_expected.translation()).norm(), 0.02) << i;
  }
  std::map<std::string, std::string> parents;
  for (const auto& transform : transforms.back().transforms()) {
    parents[transform.child_frame_id()] = transform.header().frame_id();
    EXPECT_EQ(messages::from_message(transform.header().stamp()), CameraFeed::stamp(kFrames - 1));
  }
  EXPECT_EQ(parents, (std::map<std::string, std::string>{{"odom", "map"}, {"base_link", "odom"}}));
}

TEST_F(SlamContract, LateJoinerGetsGraphPathAndStatus) {
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(track(i)) << slam.log();
  TopicProbe late("late");
  const auto& graph = late.collect(topics::kPoseGraph);
  const auto& path = late.collect(topics::kKeyframePath);
  const auto& status = late.collect(topics::kSlamStatus);
  EXPECT_TRUE(late.wait_until([&] { return !graph.empty() && !path.empty() && !status.empty(); }, Seconds(5)))
      << "graph " << graph.size() << ", path " << path.size() << ", status " << status.size();
  ASSERT_FALSE(graph.empty() || status.empty());
  EXPECT_EQ(graph[0].header().frame_id(), "map");
  EXPECT_FALSE(graph[0].nodes().empty());
  EXPECT_EQ(status[0].state(), kTracking);
}

TEST_F(SlamContract, GarbageIsCountedAndTrackingContinues) {
  int index = 0;
  for (; index < 3; ++index) ASSERT_TRUE(track(index)) << slam.log();
  const auto spoil = [&](const std::function<void(CameraFrame&)>& change) {
    auto frame = feed.frame(index++);
    change(frame);
    feed.send(frame);
    return track(index++);  // the next good frame is tracked
  };
  EXPECT_TRUE(spoil([](auto& f) { f.color->encoding("bayer_rggb8"); }));
  EXPECT_TRUE(spoil([](auto& f) { f.color->data().resize(100); }));
  EXPECT_TRUE(spoil([](auto& f) { f.color->width(0xFFFFFFFFu); }));
  EXPECT_TRUE(spoil([](auto& f) { f.depth->encoding("rgb8"); }));
  EXPECT_TRUE(spoil([](auto& f) { f.depth->data().resize(f.depth->data().size() / 2); }));
  EXPECT_TRUE(spoil([](auto& f) { f.info->width(64); }));
  EXPECT_TRUE(spoil([](auto& f) { f.info->k({}); }));
  EXPECT_TRUE(spoil([](auto& f) { f.info->distortion_model("equidistant"); }));
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(index)) << "bad frames are answered, too";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool is_spoilt = i >= 3 && i % 2 == 1;
    EXPECT_EQ(frames[i].state(), is_spoilt ? kLost : kTracking) << i << " " << frames[i].reason();
    EXPECT_NE(frames[i].reason().empty(), is_spoilt) << i;
  }
  for (const char* reason : {"colour encoding", "colour image has not step x height bytes", "larger than 16384",
                             "depth encoding", "depth image has not step x height bytes", "camera info says 64x240",
                             "no valid size", "/camera/color/camera_info: distortion model 'equidistant'"}) {
    EXPECT_TRUE(wait_for_count(reason, 1)) << reason << slam.log();
  }
  EXPECT_GE(sum_of(newest_values(diagnostics, "slam"), "frames dropped"), 8);
  EXPECT_TRUE(slam.is_running()) << slam.log();
}

TEST_F(SlamContract, FrameWithoutDepthInRangeIsLostWithTheReasonAndFoundAgain) {
  const auto set_pixels = [](sensor_msgs::msg::Image& depth, auto value) {
    for (std::size_t i = 0; i + sizeof value <= depth.data().size(); i += sizeof value)
      std::memcpy(&depth.data()[i], &value, sizeof value);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::uint16_t kFar_mm = 60'000;  // a measurement, but beyond slam's range
  int index = 0;
  for (; index < 3; ++index) ASSERT_TRUE(track(index)) << slam.log();
  std::size_t tracked = 3;
  for (const std::string kind : {"NaN", "infinity", "0", "65535", "far"}) {
    SCOPED_TRACE(kind);
    auto frame = feed.frame(index);
    if (kind == "NaN" || kind == "infinity") {
      frame.depth = feed.camera().depth_metres(CameraFeed::stamp(index), slow_motion(index));
      set_pixels(*frame.depth, kind == "NaN" ? nan : std::numeric_limits<float>::infinity());
    } else {
      set_pixels(*frame.depth, kind == "far" ? kFar_mm : static_cast<std::uint16_t>(kind == "0" ? 0 : 65535));
    }
    ASSERT_TRUE(answers(frame, index)) << slam.log();
    EXPECT_EQ(frames.back().state(), kLost);
    EXPECT_EQ(frames.back().reason(), "no depth");
    ++index;
    ASSERT_TRUE(track(index)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    ++tracked;
    ++index;
  }
  ASSERT_TRUE(probe.wait_until([&] {
    return !odometry.empty() &&
           messages::from_message(odometry.back().header().stamp()) == CameraFeed::stamp(index - 1);
  })) << slam.log();
  EXPECT_EQ(odometry.size(), tracked) << "no pose is published while lost";
  EXPECT_TRUE(std::all_of(odometry.begin(), odometry.end(), is_finite));
}

TEST_F(SlamContract, OdometryCarriesThePoseOnAndMakesTheOdomFrameItsOwn) {
  auto& wheel_odometry = probe.advertise(topics::kWheelOdometry);
  const auto& transforms = probe.collect(topics::kTransforms);
  ASSERT_TRUE(probe.wait_until([&] { return wheel_odometry.matched() > 0; })) << slam.log();
  ASSERT_TRUE(probe.wait_until_known_by("slam")) << slam.log();
  const auto feel = [&](int index, const std::string& child) {
    Odometry message;
    message.header().stamp(messages::to_message(CameraFeed::stamp(index)));
    message.header().frame_id("odom");
    message.child_frame_id(child);
    message.pose().pose(messages::to_message(T_base_camera() * slow_motion(index) * T_base_camera().inverse()));
    wheel_odometry.publish(message);
  };
  for (int i = 0; i < 4; ++i) feel(i, "base_link");
  feel(4, "wheel");
  EXPECT_TRUE(wait_for_count("child frame is 'wheel'", 1)) << slam.log();
  ASSERT_TRUE(track(0)) << slam.log();
  auto dark = feed.frame(1);
  std::fill(dark.color->data().begin(), dark.color->data().end(), std::uint8_t{0});
  ASSERT_TRUE(answers(dark, 1)) << slam.log();
  EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
  EXPECT_EQ(frames.back().source(), lapis_msgs::msg::TrackedFrame_Constants::SOURCE_SURFACES);
  const int index = 2;  // what odometry said before there was a frame carries the pose on
  auto blind = feed.frame(index);
  std::fill(blind.color->data().begin(), blind.color->data().end(), std::uint8_t{0});
  std::fill(blind.depth->data().begin() + blind.depth->step(), blind.depth->data().end(),
            std::uint8_t{0});  // but a row
  ASSERT_TRUE(answers(blind, index)) << slam.log();
  EXPECT_EQ(frames.back().state(), kDeadReckoning) << frames.back().reason();
  EXPECT_EQ(frames.back().source(), lapis_msgs::msg::TrackedFrame_Constants::SOURCE_ODOMETRY);
  EXPECT_THAT(frames.back().reason(), HasSubstr("features"));
  ASSERT_TRUE(probe.wait_until([&] {
    return messages::from_message(odometry.back().header().stamp()) == CameraFeed::stamp(index) &&
           messages::from_message(transforms.back().transforms().at(0).header().stamp()) == CameraFeed::stamp(index);
  })) << slam.log();
  EXPECT_TRUE(is_finite(odometry.back()));
  const auto& newest = transforms.back().transforms();
  ASSERT_EQ(newest.size(), 1U) << "odom -> base_link is the robot's";
  EXPECT_EQ(newest[0].child_frame_id(), "odom");
}

TEST_F(SlamContract, DuplicateAndBackwardStampsAreDropped) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(track(i)) << slam.log();
  feed.send(feed.frame(4));
  feed.send(feed.frame(2));
  ASSERT_TRUE(track(5)) << slam.log();
  EXPECT_EQ(frames.size(), 6u);
  EXPECT_TRUE(wait_for_count("stamp was there before", 1)) << slam.log();
  EXPECT_TRUE(wait_for_count("older than what was processed", 1)) << slam.log();
}

TEST_F(SlamContract, FrameWithoutDepthIsCounted) {
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(track(i)) << slam.log();
  auto blind = feed.frame(3);
  blind.depth.reset();
  feed.send(blind);
  ASSERT_TRUE(track(4)) << slam.log();
  EXPECT_EQ(frames.back().state(), kTracking);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_EQ(frames[3].state(), kLost);
  EXPECT_THAT(frames[3].reason(), HasSubstr("no depth image"));
  EXPECT_TRUE(wait_for_count("no depth image", 1)) << slam.log();
}

// Who waits for a first pose reads why there is none, within two seconds.
TEST_F(SlamContract, SaysWhatItLacksForAFirstPose) {
  const auto& status = probe.collect(topics::kSlamStatus);
  const auto says = [&](const std::string& reason) {
    return probe.wait_until([&] { return !status.empty() && status.back().reason().find(reason) == 0; }, Seconds(2));
  };
  EXPECT_TRUE(says("waits for the camera's images")) << slam.log();
  auto wall = feed.frame(0);
  std::fill(wall.color->data().begin(), wall.color->data().end(), std::uint8_t{200});
  ASSERT_TRUE(answers(wall, 0)) << slam.log();
  EXPECT_EQ(frames.back().state(), kInitializing);
  EXPECT_THAT(frames.back().reason(), HasSubstr("a blank wall?): 0 features with depth"));
  EXPECT_TRUE(says(frames.back().reason())) << status.back().reason() << slam.log();
  EXPECT_EQ(status.back().state(), kInitializing);
  ASSERT_TRUE(track(1)) << slam.log();
  EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
}

TEST_F(SlamContract, SilenceIsSurvivedAndEndsCleanly) {
  ASSERT_TRUE(track(0)) << slam.log();
  const auto seen = diagnostics.size();
  EXPECT_TRUE(probe.wait_until([&] { return diagnostics.size() >= seen + 3; })) << "diagnostics continue without input";
  EXPECT_EQ(slam.stop(SIGTERM, Seconds(5)), 0) << slam.log();
}

TEST(SlamPeer, NewCameraIsTrackedAsWell) {
  ChildProcess slam(kSlam);
  ASSERT_TRUE(wait_until_ready(slam)) << slam.log();
  int index = 0;
  for (int life = 0; life < 2; ++life) {
    TopicProbe probe;
    CameraFeed feed(probe);
    const auto& frames = probe.collect(topics::kTrackedFrame);
    // Repeated with new stamps: the first ones may be sent before the match.
    ASSERT_TRUE(probe.wait_until([&] {
      feed.send(feed.frame(index++));
      probe.wait_until([] { return false; }, Seconds(0.05));
      return !frames.empty() && frames.back().state() == kTracking;
    })) << life
        << slam.log();
  }
}

TEST(SlamNamespace, PrefixesFrames) {
  TopicProbe probe("probe", "robot1");
  CameraFeed feed(probe, "robot1/");
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  ChildProcess slam(kSlam, {"--namespace", "robot1"});
  ASSERT_TRUE(wait_until_ready(slam)) << slam.log();
  int index = 0;
  ASSERT_TRUE(probe.wait_until([&] {
    feed.send(feed.frame(index++));
    probe.wait_until([] { return false; }, Seconds(0.05));
    return !odometry.empty();
  })) << slam.log();
  EXPECT_EQ(odometry[0].header().frame_id(), "robot1/map");
  EXPECT_EQ(odometry[0].child_frame_id(), "robot1/base_link");
}

}  // namespace
}  // namespace lapis::test
