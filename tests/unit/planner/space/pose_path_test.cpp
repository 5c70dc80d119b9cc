#include "planner/core/space/pose_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using test::TextWorld;
using testing::IsEmpty;
using testing::Optional;

const GridConfig kNoClearance = {.band = {}, .footprint_radius_m = 0.05, .margin_m = 0.0};
constexpr double kSpacing_m = 0.1;

Pose2 pose_at(const TextWorld& world, char place, double yaw_rad = 0.0) {
  return {world.grid.center_of(world.places.at(place)), yaw_rad};
}

std::vector<Pose2> path_between(const TextWorld& world, char from, char to) {
  return pose_path_to(pose_at(world, to, 1.5), pose_at(world, from), world.grid, {}, kSpacing_m);
}

TEST(PosePathTo, LeadsFromTheRobotToThePlace) {
  const TextWorld world({"A...B"}, 0.25, kNoClearance);
  const std::vector<Pose2> poses = path_between(world, 'A', 'B');
  ASSERT_GE(poses.size(), 11u);
  EXPECT_EQ(poses.front().p_map, pose_at(world, 'A').p_map);
  EXPECT_EQ(poses.back().p_map, pose_at(world, 'B').p_map);
  EXPECT_EQ(poses.back().yaw_rad, 1.5);
}

TEST(PosePathTo, EndsAsNearAsItGetsToAPlaceBesideAWall) {
  const TextWorld world({"A...C#B#"}, 0.25, kNoClearance);
  EXPECT_EQ(path_between(world, 'A', 'B').back().p_map, pose_at(world, 'C').p_map);
}

TEST(PosePathTo, IsEmptyWhenNothingWithinAMetreCanBeReached) {
  const TextWorld world({"A...#....B"}, 0.25, kNoClearance);
  EXPECT_THAT(path_between(world, 'A', 'B'), IsEmpty());
}

TEST(IsPathFree, LooksAtWhatIsAheadAndNotNear) {
  //                     1 m: four cells
  const TextWorld world({"#A.#B....#C"}, 0.25, kNoClearance);
  std::vector<Pose2> path;
  for (int x = 0; x <= 10; ++x) path.push_back({world.grid.center_of({x, 0}), 0.0});
  EXPECT_FALSE(is_path_free(path, pose_at(world, 'A'), world.grid)) << "the wall before C";
  path.resize(9);
  EXPECT_TRUE(is_path_free(path, pose_at(world, 'A'), world.grid)) << "one wall is near, the other behind";
  EXPECT_TRUE(is_path_free(path, pose_at(world, 'B'), world.grid)) << "both are behind";
  EXPECT_TRUE(is_path_free({}, pose_at(world, 'A'), world.grid));
}

TEST(PlaceAhead, IsOnThePathThatIsLeft) {
  std::vector<Pose2> path;
  for (int i = 0; i <= 20; ++i) path.push_back({{0.1 * i, 0.0}, 0.0});
  EXPECT_THAT(place_ahead(path, {{1.02, 0.05}, 0.0}), Optional(path[14].p_map));
  EXPECT_EQ(place_ahead(path, path[18]), std::nullopt) << "nothing is so far ahead any more";
  EXPECT_EQ(place_ahead({}, {}), std::nullopt);
}

TEST(WithTurns, ShowsHeadingsOnTheShorterWayRound) {
  const std::vector<Pose2> path{{{1.0, 2.0}, 3.0}, {{2.0, 2.0}, 3.0}, {{3.0, 2.0}, -3.0}};
  const std::vector<Pose2> poses = with_turns(path, 1.0, 0.5);
  ASSERT_EQ(poses.size(), 6u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(poses[static_cast<std::size_t>(i)].yaw_rad, 1.5 + 0.5 * i, 1e-12);
    EXPECT_EQ(poses[static_cast<std::size_t>(i)].p_map, path[0].p_map);
  }
  EXPECT_EQ(poses[4].p_map, path[1].p_map);
  EXPECT_EQ(poses[5].yaw_rad, -3.0) << "0.28 rad through pi";
  EXPECT_EQ(with_turns(path, 3.0, 0.5).size(), 3u);
  EXPECT_TRUE(with_turns({}, 3.0, 0.5).empty());
}

}  // namespace
}  // namespace lapis::planner
