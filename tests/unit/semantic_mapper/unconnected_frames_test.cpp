// Frames in a sub-map of slam wait until the pose graph lists their key-frames.
#include "semantic_mapper/core/unconnected_frames.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;

constexpr geometry::PinholeCamera kCoarseCamera{80, 45, 40, 40, 39.5, 22.0};

Pose keyframe_pose(std::uint64_t id) {
  return lapis::test::look({0.3 * static_cast<double>(id), 0.2, 1.0}, 0.2 * static_cast<double>(id), 0.1);
}

UnconnectedFrame frame_of(std::uint64_t id, std::int64_t stamp) {
  const auto image = lapis::test::render(lapis::test::furnished_room(), kCoarseCamera, keyframe_pose(id));
  std::string error;
  return {time::Time{stamp}, id, Pose::Identity(),
          mapping::CompactFrame::make(kCoarseCamera, image.depth, &image.labels, {1, 40}, error).value(), true};
}

TEST(UnconnectedFrames, WaitForTheirKeyframesAndComeInTheOrderOfTime) {
  UnconnectedFrames frames(1 << 20);
  for (std::uint64_t id = 5; id < 8; ++id) frames.add(frame_of(id, static_cast<std::int64_t>(id)));
  EXPECT_FALSE(frames.take_placed());
  const std::vector<KeyframePose> without{{1, keyframe_pose(1)}};
  frames.place(2, without);
  EXPECT_FALSE(frames.take_placed());
  const std::vector<KeyframePose> listed{{1, keyframe_pose(1)}, {5, keyframe_pose(5)}, {7, keyframe_pose(7)}};
  frames.place(3, listed);
  EXPECT_EQ(frames.size(), 3U);
  for (const std::uint64_t id : {5U, 7U}) {
    const auto placed = frames.take_placed();
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->keyframe_id, id);
    EXPECT_EQ(placed->stamp, time::Time{static_cast<std::int64_t>(id)});
    EXPECT_EQ(placed->graph_version, 3U);
    EXPECT_TRUE(placed->T_map_keyframe.isApprox(keyframe_pose(id)));
    EXPECT_TRUE(placed->drift.is_none());
    EXPECT_EQ(mapping::pack(placed->frame), mapping::pack(frame_of(id, 0).frame));
  }
  EXPECT_FALSE(frames.take_placed());
  EXPECT_EQ(frames.size(), 1U);
  frames.clear();
  frames.place(4, {{KeyframePose{6, keyframe_pose(6)}}});
  EXPECT_FALSE(frames.take_placed());
}

TEST(UnconnectedFrames, BeyondTheBudgetTheOldestAreLetGo) {
  const std::size_t bytes = mapping::pack(frame_of(5, 0).frame).size();
  UnconnectedFrames frames(2 * bytes + bytes / 2);
  for (int i = 0; i < 4; ++i) frames.add(frame_of(5, i));
  EXPECT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames.let_go(), 2U);
  frames.place(1, {{KeyframePose{5, keyframe_pose(5)}}});
  const auto placed = frames.take_placed();
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->stamp, time::Time{2});
}

}  // namespace
}  // namespace lapis::semantic_mapper
