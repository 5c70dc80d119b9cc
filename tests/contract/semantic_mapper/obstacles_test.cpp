// The obstacle layer of lapis_semantic_mapper: what stands in the way now, beside a map that takes the world to be
// static.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/topics/map.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"

namespace lapis::test {
namespace {

using nav_msgs::msg::OccupancyGrid;

constexpr int kOccupied = 100, kFree = 0, kUnknown = -1;
constexpr int kFramesIn5s = 150;

int value_at(const OccupancyGrid& grid, const Eigen::Vector3d& p_map) {
  const auto& origin = grid.info().origin().position();
  const auto column = static_cast<int>(std::floor((p_map.x() - origin.x()) / grid.info().resolution()));
  const auto row = static_cast<int>(std::floor((p_map.y() - origin.y()) / grid.info().resolution()));
  const auto width = static_cast<int>(grid.info().width()), height = static_cast<int>(grid.info().height());
  if (column < 0 || row < 0 || column >= width || row >= height) return kUnknown;
  return grid.data()[static_cast<std::size_t>(row) * grid.info().width() + static_cast<std::size_t>(column)];
}

class Obstacles : public MapperContract {
 protected:
  /// Somebody stands in front of the camera: all that is further in the middle of the image is now at 1 m.
  static CameraFrame blocked(CameraFrame frame) {
    auto& depth = *frame.depth;
    for (std::uint32_t row = 0; row < depth.height(); ++row) {
      for (std::uint32_t column = depth.width() / 3; column < 2 * depth.width() / 3; ++column) {
        const std::size_t at = row * depth.step() + 2 * column;
        depth.data()[at] = 1000 & 0xff;
        depth.data()[at + 1] = 1000 >> 8;
      }
    }
    return frame;
  }
  /// Sends frames until the newest grid has that value where the obstacle is; the number of frames, or nothing.
  std::optional<int> frames_until(int value, bool is_blocked) {
    for (int sent = 1; sent <= kFramesIn5s; ++sent) {
      ++index_;
      const std::uint64_t before = client.states.empty() ? 0 : client.states.back().frames_integrated();
      const auto stamp = CameraFeed::stamp(index_);
      const auto frame = feed.frame(stamp, slow_motion(0));  // the camera stands still
      feed.send(is_blocked ? blocked(frame) : frame);
      auto pose = tracked(index_);
      pose.pose_in_keyframe(messages::to_message(slow_motion(0)));
      slam.publish(pose);
      if (!probe.wait_until(
              [&] { return !client.states.empty() && client.states.back().frames_integrated() > before; }))
        return std::nullopt;
      const bool has_grid =
          probe.wait_until([&] { return !grids.empty() && (stamp - stamp_of(grids.back())).seconds() < 0.5; });
      if (has_grid && value_at(grids.back(), p_obstacle()) == value) return sent;
    }
    return std::nullopt;
  }
  static Eigen::Vector3d p_obstacle() { return T_base_camera() * Eigen::Vector3d(0.0, -0.1, 1.0); }
  static time::Time stamp_of(const OccupancyGrid& grid) { return messages::from_message(grid.header().stamp()); }

  const std::vector<OccupancyGrid>& grids = probe.collect(topics::kObstacles);
  int index_ = 0;
};

TEST_F(Obstacles, AMovedOneIsFollowedWithinFiveSecondsBothWays) {
  ASSERT_TRUE(frames_until(kFree, false)) << mapper.log();
  const auto appeared = frames_until(kOccupied, true);
  ASSERT_TRUE(appeared) << mapper.log();
  for (int i = 0; i < kFramesIn5s; ++i) {  // long enough for a static map to believe in it
    ASSERT_EQ(frames_until(kOccupied, true), 1) << mapper.log();
  }
  const auto disappeared = frames_until(kFree, false);
  ASSERT_TRUE(disappeared) << mapper.log();
  RecordProperty("frames_to_appear", *appeared);
  RecordProperty("frames_to_disappear", *disappeared);
}

TEST_F(Obstacles, GridsComeFifteenTimesASecondOfStampsAndToLateJoiners) {
  for (int i = 0; i < 46; ++i)
    ASSERT_TRUE(map_frame(i)) << mapper.log();  // 1.5 s at 30 Hz: every second one has a grid
  ASSERT_TRUE(probe.wait_until([&] { return grids.size() == 23; })) << grids.size() << mapper.log();
  for (std::size_t i = 1; i < grids.size(); ++i) {
    EXPECT_NEAR((stamp_of(grids[i]) - stamp_of(grids[i - 1])).seconds(), 1.0 / 15.0, 0.001);
  }
  EXPECT_EQ(grids.back().header().frame_id(), "map");
  EXPECT_EQ(grids.back().data().size(),
            static_cast<std::size_t>(grids.back().info().width()) * grids.back().info().height());
  TopicProbe late("late");
  const auto& seen = late.collect(topics::kObstacles);
  ASSERT_TRUE(late.wait_until([&] { return !seen.empty(); })) << mapper.log();
  EXPECT_EQ(seen.back(), grids.back());
}

/// Each frame gives one grid.
struct SeenObstacles {
  SeenObstacles() : run({"semantic_mapper.obstacle_period_s=0.03"}) {}

  /// Waits for the grid of a frame.
  bool has_grid(int index) {
    return run.probe.wait_until([&] {
      return !grids.empty() && messages::from_message(grids.back().header().stamp()) == CameraFeed::stamp(index);
    });
  }

  MapperRun run;
  const std::vector<OccupancyGrid>& grids = run.probe.collect(topics::kObstacles);
};

TEST(ObstaclesOfFrames, DoNotWaitForLabelsAndAreTheSame) {
  constexpr int kFrames = 36, kSteps = 12;  // 1.2 s; every third frame, so that the camera sees something new
  const auto send_bare = [](MapperRun& run, int index) {
    CameraFrame frame = run.feed.frame(index);
    const auto labels = *frame.labels;
    frame.labels.reset();
    run.send(frame, index);
    return labels;
  };
  std::vector<OccupancyGrid> expected;
  {
    SeenObstacles at_once;
    ASSERT_TRUE(at_once.run.is_ready()) << at_once.run.mapper.log();
    for (int i = 0; i < kFrames; i += kFrames / kSteps) {
      at_once.run.send(at_once.run.feed.frame(i), i);
      ASSERT_TRUE(at_once.has_grid(i)) << i << at_once.run.mapper.log();
    }
    expected = at_once.grids;
  }
  SeenObstacles late;
  MapperRun& run = late.run;
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  std::vector<sensor_msgs::msg::Image> labels;
  for (int i = 0; i < kFrames; i += kFrames / kSteps) {
    labels.push_back(send_bare(run, i));
    ASSERT_TRUE(late.has_grid(i)) << i << run.mapper.log();
  }
  EXPECT_FALSE(run.client.has_map()) << "frames wait for labels";
  ASSERT_EQ(late.grids.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(late.grids[i], expected[i]) << i;
  for (std::size_t i = 0; i < labels.size(); ++i) {  // no more at once than a reader keeps
    run.feed.send({.color = {}, .depth = {}, .labels = labels[i], .info = {}});
    ASSERT_TRUE(run.probe.wait_until([&] {
      return !run.client.states.empty() && run.client.states.back().frames_integrated() > i && run.client.has_map();
    })) << run.mapper.log();
  }
  run.client.mirror.map()->for_each_observed([&](const auto&, const mapping::VoxelCounts& counts) {
    for (const auto& hit : counts.hits) EXPECT_NE(hit.label, 0);
  });
  EXPECT_EQ(late.grids.size(), expected.size()) << "labels change nothing in them";
}

// The frames of before need not wait for labels any longer, and slam's new map is driven in at once.
TEST(ObstaclesOfFrames, OfANewSessionDoNotWaitForItsLabels) {
  SeenObstacles late;
  MapperRun& run = late.run;
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  for (const int i : {0, 3, 6}) {
    CameraFrame frame = run.feed.frame(i);
    frame.labels.reset();
    run.send(frame, i, i < 6 ? 1 : 2);
    ASSERT_TRUE(late.has_grid(i)) << i << run.mapper.log();
  }
  EXPECT_EQ(run.mapper.stop(SIGTERM), 0) << run.mapper.log();
  EXPECT_THAT(run.mapper.log(), ::testing::HasSubstr("3 frames integrated, 0 dropped"));
}

// A robot that slam does not track goes by odometry, and its controller stands still without a map.
TEST_F(Obstacles, GridsContinueWhileSlamDoesNotTrack) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  ASSERT_TRUE(probe.wait_until([&] { return grids.size() == 1; })) << mapper.log();
  auto lost = tracked(2);
  lost.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_LOST);
  feed.send(feed.frame(CameraFeed::stamp(2), slow_motion(0)));
  slam.publish(lost);
  ASSERT_TRUE(probe.wait_until([&] { return grids.size() == 2; })) << mapper.log();
  EXPECT_EQ(stamp_of(grids[1]), CameraFeed::stamp(2));
  EXPECT_EQ(grids[1].data(), grids[0].data());
}

}  // namespace
}  // namespace lapis::test
