// What slam finds out about the depth camera counts for the mapper as long as that slam publishes the frames.
#include <gtest/gtest.h>

#include <optional>

#include "common/messages/camera.hpp"
#include "common/messages/depth_converter.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"

namespace lapis::test {
namespace {

/// A process that plays slam. As slam does, it announces its estimates before its frames, so who reads both knows of
/// them when a frame comes.
struct Slam {
  explicit Slam(bool estimates)
      : estimate(estimates ? &probe.advertise(topics::kDepthEstimate) : nullptr),
        frames(probe.advertise(topics::kTrackedFrame)) {}
  bool is_known() {
    return probe.wait_until([&] { return frames.matched() > 0 && (estimate == nullptr || estimate->matched() > 0); });
  }
  void say(const sensor_msgs::msg::CameraInfo& info) const {
    estimate->publish(info);
    EXPECT_TRUE(estimate->wait_until_acknowledged(5.0));
  }

  TopicProbe probe{"slam"};
  dds::Publisher<sensor_msgs::msg::CameraInfo>* estimate;  // null: it estimates nothing
  dds::Publisher<lapis_msgs::msg::TrackedFrame>& frames;
};

/// Both cameras are in one place, and depth has `share` of the focal length of colour.
sensor_msgs::msg::CameraInfo estimate_of(const sensor_msgs::msg::CameraInfo& color_info, double share) {
  const auto color = *messages::lens_camera(color_info);
  auto depth = color;
  depth.pinhole.fx *= share;
  depth.pinhole.fy *= share;
  return messages::to_depth_info({}, {color, depth});
}

/// The camera stands still, so that only the calibration makes a difference.
CameraFrame frame_at(const MapperRun& run, int index) {
  return run.feed.frame(CameraFeed::stamp(index), slow_motion(0));
}
lapis_msgs::msg::TrackedFrame tracked_at(const MapperRun& run, int index, std::int64_t session) {
  auto message = run.tracked(index, session);
  message.pose_in_keyframe(messages::to_message(slow_motion(0)));
  return message;
}

/// The map of a frame, by a slam with that estimate.
mapping::VoxelMap map_by(std::optional<double> share) {
  MapperRun run;
  Slam slam(share.has_value());
  EXPECT_TRUE(run.is_ready() && slam.is_known()) << run.mapper.log();
  if (share) slam.say(estimate_of(*frame_at(run, 0).info, *share));
  run.feed.send(frame_at(run, 0));
  slam.frames.publish(tracked_at(run, 0, 1));
  EXPECT_TRUE(run.probe.wait_until([&] { return run.client.has_map(); })) << run.mapper.log();
  return run.client.has_map() ? *run.client.mirror.map() : mapping::VoxelMap(0.25);
}

/// Maps of a frame by slams that know their own estimates only. They are made before the mapper under test is there.
struct ExpectedMaps {
  const mapping::VoxelMap without = map_by(std::nullopt);
  const mapping::VoxelMap with_next = map_by(0.8);
};
const ExpectedMaps& expected_maps() {
  static const ExpectedMaps kMaps;
  return kMaps;
}

/// A slam that estimates the depth camera has died, and the next one begins another session.
class EstimateOfADeadSlam : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    Slam dead(true);
    ASSERT_TRUE(dead.is_known());
    dead.say(estimate_of(*frame_at(run, 1).info, 0.7));
    run.feed.send(frame_at(run, 1));
    dead.frames.publish(tracked_at(run, 1, 1));
    ASSERT_TRUE(run.probe.wait_until([&] { return run.client.has_map(); })) << run.mapper.log();
    ASSERT_NE(*run.client.mirror.map(), expected.without) << "the estimate counts";
  }
  bool has_map_of_session(std::int64_t session) {
    return run.probe.wait_until([&] { return run.client.has_map() && run.client.states.back().session() == session; });
  }

  const ExpectedMaps& expected = expected_maps();
  MapperRun run;
};

TEST_F(EstimateOfADeadSlam, CountsNoMoreWhenTheNextOneEstimatesNothing) {
  Slam next(false);
  ASSERT_TRUE(next.is_known());
  run.feed.send(frame_at(run, 2));
  next.frames.publish(tracked_at(run, 2, 2));
  ASSERT_TRUE(has_map_of_session(2)) << run.mapper.log();
  EXPECT_EQ(*run.client.mirror.map(), expected.without);
}

TEST_F(EstimateOfADeadSlam, IsFollowedByThatOfTheNextOneForWhichFramesWait) {
  Slam next(true);
  ASSERT_TRUE(next.is_known());
  const auto frame = frame_at(run, 2);
  run.feed.send(frame);
  next.frames.publish(tracked_at(run, 2, 2));
  run.feed.send({.color = {}, .depth = frame.depth, .labels = {}, .info = {}});  // when it is refused, all have come
  ASSERT_TRUE(run.wait_for_count("depth dropped: stamp was there before", 1)) << run.mapper.log();
  EXPECT_EQ(run.client.states.back().session(), 1);
  next.say(estimate_of(*frame.info, 0.8));
  ASSERT_TRUE(has_map_of_session(2)) << run.mapper.log();
  EXPECT_EQ(*run.client.mirror.map(), expected.with_next);
}

TEST_F(EstimateOfADeadSlam, DoesNotTakeThePlaceOfWhatTheNextOneHasSaid) {
  Slam next(true);
  ASSERT_TRUE(next.is_known());
  next.say(estimate_of(*frame_at(run, 2).info, 0.8));
  run.feed.send(frame_at(run, 2));
  next.frames.publish(tracked_at(run, 2, 2));
  ASSERT_TRUE(has_map_of_session(2)) << run.mapper.log();
  EXPECT_EQ(*run.client.mirror.map(), expected.with_next);
}

}  // namespace
}  // namespace lapis::test
