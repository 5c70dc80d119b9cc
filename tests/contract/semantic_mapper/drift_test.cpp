// lapis_semantic_mapper while slam goes by odometry alone: the frames wait, are seen as obstacles and as a provisional
// area meanwhile, and enter the map when the pose graph has corrected their key-frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"

namespace lapis::test {
namespace {

using lapis_msgs::msg::TrackedFrame;
using nav_msgs::msg::OccupancyGrid;

class BlindMapper : public MapperContract {
 protected:
  static constexpr std::uint64_t kHeld = 3, kDrifting = 7;
  /// Half a voxel is exceeded everywhere.
  static constexpr double kDrift_m = 0.3;

  static TrackedFrame on_keyframe(std::uint64_t keyframe, bool is_keyframe, std::int64_t session) {
    TrackedFrame frame;
    frame.header().frame_id(SyntheticCamera::kOpticalFrame);
    frame.map_frame_id("map");
    frame.session(session);
    frame.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING);
    frame.source(lapis_msgs::msg::TrackedFrame_Constants::SOURCE_VISION);
    frame.keyframe_id(keyframe);
    frame.is_keyframe(is_keyframe);
    frame.graph_version(1);
    frame.keyframe_pose(messages::to_message(T_base_camera()));
    return frame;
  }
  static TrackedFrame blind(bool is_keyframe) {
    TrackedFrame frame = on_keyframe(kDrifting, is_keyframe, 1);
    frame.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_DEAD_RECKONING);
    frame.source(lapis_msgs::msg::TrackedFrame_Constants::SOURCE_ODOMETRY);
    frame.drift_m(kDrift_m);
    frame.drift_rad(0.05);
    frame.keyframe_pose().position().x(frame.keyframe_pose().position().x() + kDrift_m);
    return frame;
  }
  /// In a sub-map: nobody knows where in the map its key-frame is.
  static TrackedFrame unconnected(bool is_keyframe) {
    TrackedFrame frame = on_keyframe(kDrifting, is_keyframe, 1);
    frame.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED);
    frame.source(lapis_msgs::msg::TrackedFrame_Constants::SOURCE_NONE);
    frame.keyframe_pose({});
    return frame;
  }
  /// At one time, what the slow motion shows at another.
  void send_frame(int at, int shown, TrackedFrame frame) {
    frame.header().stamp(messages::to_message(CameraFeed::stamp(at)));
    frame.pose_in_keyframe(messages::to_message(slow_motion(shown)));
    feed.send(feed.frame(CameraFeed::stamp(at), slow_motion(shown)));
    slam.publish(frame);
  }
  bool has_mapped(int index, std::int64_t session) {
    return probe.wait_until([&] {
      return client.has_map() && client.states.back().session() == session &&
             messages::from_message(client.states.back().header().stamp()) == CameraFeed::stamp(index);
    });
  }
  void publish_graph(std::uint64_t version, const TrackedFrame& of_drifting, bool is_drifting) {
    lapis_msgs::msg::PoseGraph message;
    message.session(1);
    message.version(version);
    lapis_msgs::msg::PoseGraphNode held, drifting;
    held.id(kHeld);
    held.pose(messages::to_message(T_base_camera()));
    drifting.id(kDrifting);
    drifting.pose(of_drifting.keyframe_pose());
    drifting.is_drifting(is_drifting);
    message.nodes({held, drifting});
    graph.publish(message);
  }
  static time::Time stamp_of(const OccupancyGrid& grid) { return messages::from_message(grid.header().stamp()); }
  static std::ptrdiff_t count(const OccupancyGrid& grid, int value) {
    return std::count(grid.data().begin(), grid.data().end(), value);
  }
  bool wait_for_waiting(double frames, const char* which = "frames_waiting") {
    return probe.wait_until([&] {
      const auto values = newest_values(diagnostics, "semantic_mapper");
      return values.contains(which) && sum_of(values, which) == frames;
    });
  }

  dds::Publisher<lapis_msgs::msg::PoseGraph>& graph = probe.advertise(topics::kPoseGraph);
  const std::vector<OccupancyGrid>& areas = probe.collect(topics::kProvisionalArea);
  const std::vector<OccupancyGrid>& obstacles = probe.collect(topics::kObstacles);
};

TEST_F(BlindMapper, FramesWaitAsAProvisionalAreaAndComeInWholeWithTheCorrection) {
  ASSERT_TRUE(probe.wait_until([&] {
    return graph.matched() > 0 && !client.descriptions.empty() && client.descriptions.back().labels.size() > 0;
  })) << mapper.log();
  send_frame(0, 0, on_keyframe(kHeld, true, 1));
  ASSERT_TRUE(has_mapped(0, 1)) << mapper.log();
  ASSERT_TRUE(probe.wait_until([&] { return areas.size() == 1 && obstacles.size() == 1; })) << mapper.log();
  EXPECT_TRUE(areas[0].data().empty()) << "nothing waits";
  const mapping::VoxelMap before = *client.mirror.map();

  send_frame(15, 31, blind(true));  // less than a second later: a larger jump would be in doubt
  send_frame(30, 62, blind(false));
  ASSERT_TRUE(wait_for_waiting(2)) << mapper.log();
  ASSERT_TRUE(probe.wait_until([&] { return !areas.empty() && stamp_of(areas.back()) == CameraFeed::stamp(30); }))
      << mapper.log();
  EXPECT_EQ(areas.back().header().frame_id(), "map");
  EXPECT_GT(count(areas.back(), 0), 20);
  EXPECT_EQ(count(areas.back(), 0) + count(areas.back(), -1), std::ssize(areas.back().data()));
  EXPECT_EQ(*client.mirror.map(), before);
  ASSERT_TRUE(probe.wait_until([&] { return stamp_of(obstacles.back()) == CameraFeed::stamp(30); })) << mapper.log();
  EXPECT_NE(obstacles.back().data(), obstacles.front().data()) << "they are seen where odometry has them";

  publish_graph(2, blind(true), true);
  publish_graph(3, on_keyframe(kDrifting, true, 1), false);
  ASSERT_TRUE(has_mapped(30, 1)) << mapper.log();
  ASSERT_TRUE(wait_for_waiting(0)) << mapper.log();
  const mapping::VoxelMap corrected = *client.mirror.map();

  send_frame(45, 0, on_keyframe(kHeld, true, 2));
  send_frame(46, 31, on_keyframe(kDrifting, true, 2));
  send_frame(47, 62, on_keyframe(kDrifting, false, 2));
  ASSERT_TRUE(has_mapped(47, 2)) << mapper.log();
  EXPECT_EQ(corrected, *client.mirror.map()) << "as of frames that vision held all the time";
  EXPECT_NE(corrected, before);
  EXPECT_TRUE(areas.back().data().empty());
}

TEST_F(BlindMapper, FramesOfASubMapEnterTheMapWhenTheGraphListsTheirKeyframe) {
  ASSERT_TRUE(probe.wait_until([&] {
    return graph.matched() > 0 && !client.descriptions.empty() && client.descriptions.back().labels.size() > 0;
  })) << mapper.log();
  send_frame(0, 0, on_keyframe(kHeld, true, 1));
  ASSERT_TRUE(has_mapped(0, 1)) << mapper.log();
  const mapping::VoxelMap before = *client.mirror.map();
  send_frame(15, 31, unconnected(true));
  send_frame(30, 62, unconnected(false));
  ASSERT_TRUE(wait_for_waiting(2, "frames_unconnected")) << mapper.log();
  EXPECT_EQ(*client.mirror.map(), before);

  publish_graph(2, on_keyframe(kDrifting, true, 1), false);
  ASSERT_TRUE(probe.wait_until([&] { return client.has_map() && *client.mirror.map() != before; })) << mapper.log();
  ASSERT_TRUE(wait_for_waiting(0, "frames_unconnected")) << mapper.log();
  const mapping::VoxelMap joined = *client.mirror.map();

  send_frame(45, 0, on_keyframe(kHeld, true, 2));
  send_frame(46, 31, on_keyframe(kDrifting, true, 2));
  send_frame(47, 62, on_keyframe(kDrifting, false, 2));
  ASSERT_TRUE(has_mapped(47, 2)) << mapper.log();
  EXPECT_EQ(joined, *client.mirror.map()) << "as of frames that had a pose in the map all the time";
}

TEST_F(BlindMapper, ANewSessionForgetsTheFramesThatWait) {
  send_frame(0, 0, blind(true));
  send_frame(1, 1, blind(false));
  ASSERT_TRUE(wait_for_waiting(2)) << mapper.log();
  ASSERT_TRUE(probe.wait_until([&] { return !areas.empty() && count(areas.back(), 0) > 0; })) << mapper.log();
  ASSERT_TRUE(map_frame(40, 2)) << mapper.log();
  ASSERT_TRUE(wait_for_waiting(0)) << mapper.log();
  ASSERT_TRUE(probe.wait_until([&] { return areas.back().data().empty(); })) << mapper.log();
  EXPECT_THAT(mapper.log(), ::testing::HasSubstr("2 frames at poses by odometry alone wait for a correction"));
}

}  // namespace
}  // namespace lapis::test
