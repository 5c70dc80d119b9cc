#include "planner/core/space/viewpoints.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using test::TextWorld;

const ViewpointConfig kConfig{.min_distance_m = 0.5, .max_distance_m = 1.5, .max_per_frontier = 6};

/// The result for the frontier that contains a cell.
ViewpointResult views_of(const TextWorld& world, Cell robot, Cell of, const ViewpointConfig& config = kConfig) {
  FrontierMap map({});
  map.update(world.grid, world.known);
  const CostTree paths = grow_cost_tree(world.grid, {}, {robot});
  for (const auto& [id, frontier] : map.frontiers())
    if (std::find(frontier.cells.begin(), frontier.cells.end(), of) != frontier.cells.end())
      return sample_viewpoints(world.grid, paths, frontier, config);
  ADD_FAILURE() << "no such frontier";
  return {};
}

const std::vector<std::string> kRoom = {
    "####    ####",  //
    "#...FFFF...#",  //
    "#..........#",  //
    "#..........#",  //
    "#..........#",  //
    "#..........#",  //
    "############",
};

TEST(Viewpoints, SeeTheFrontierFromTheRing) {
  const TextWorld world(kRoom);
  const Cell robot{2, 2};
  const ViewpointResult result = views_of(world, robot, {5, 5});
  ASSERT_EQ(result.rejection, Rejection::kNone);
  EXPECT_GE(result.viewpoints.size(), 3u);
  EXPECT_LE(result.viewpoints.size(), 6u);
  std::set<int> sectors;
  for (const Viewpoint& view : result.viewpoints) {
    EXPECT_TRUE(world.grid.is_traversable(view.cell));
    const Eigen::Vector2d to_target = world.grid.center_of(view.target) - view.pose.p_map;
    EXPECT_GE(to_target.norm(), 0.5 - 1e-9);
    EXPECT_LE(to_target.norm(), 1.5 + 1e-9);
    EXPECT_NEAR(view.pose.yaw_rad, std::atan2(to_target.y(), to_target.x()), 1e-12);
    EXPECT_EQ(world.grid.cell_of(view.pose.p_map), view.cell);
    EXPECT_GE(view.cost_m, distance(robot, view.cell) * 0.25 - 1e-9);
    sectors.insert(static_cast<int>(std::floor((view.pose.yaw_rad + 4.0) / (6.283185307 / 6.0) * 10)));
  }
  EXPECT_EQ(sectors.size(), result.viewpoints.size()) << "all from other directions";
}

TEST(Viewpoints, AreReproducibleAndMoveWithTheSeed) {
  const TextWorld world(kRoom);
  const auto cells = [&](std::int64_t seed) {
    ViewpointConfig config = kConfig;
    config.seed = seed;
    std::vector<Cell> cells_of;
    for (const Viewpoint& view : views_of(world, {2, 2}, {5, 5}, config).viewpoints) cells_of.push_back(view.cell);
    return cells_of;
  };
  EXPECT_EQ(cells(1), cells(1));
  EXPECT_NE(cells(1), cells(2));
}

TEST(Viewpoints, TheNearestIsInFrontOfTheMiddle) {
  const TextWorld world(kRoom);
  const ViewpointConfig config{
      .min_distance_m = 0.0, .max_distance_m = 1.5, .max_per_frontier = 1, .nearest_first = true};
  const auto views = views_of(world, {2, 2}, {5, 5}, config).viewpoints;
  ASSERT_EQ(views.size(), 1u);
  const double nearest = distance(views[0].cell, views[0].target);
  for (Cell c{0, 0}; c.y < 7; ++c.y) {
    for (c.x = 0; c.x < 12; ++c.x) {
      if (!world.grid.is_traversable(c)) continue;
      EXPECT_GE(distance(c, views[0].target), nearest);
    }
  }
}

TEST(Viewpoints, BehindGlassIsUnreachable) {
  const TextWorld world({"##############", "#....#........", "#....#........", "#....#........", "##############"});
  EXPECT_EQ(views_of(world, {2, 2}, {13, 2}).rejection, Rejection::kUnreachable);
  EXPECT_EQ(views_of(world, {7, 2}, {13, 2}).rejection, Rejection::kNone);
}

TEST(Viewpoints, ASlotHasNoRoom) {
  GridConfig wide;
  wide.footprint_radius_m = 0.45;
  const TextWorld world({"########", "........", "########"}, 0.25, wide);
  EXPECT_EQ(views_of(world, {2, 1}, {0, 1}).rejection, Rejection::kNoRoom);
}

TEST(Viewpoints, HiddenBehindAWall) {
  // The only path to the frontier is too narrow for the robot, which can come near it on the other side of a wall.
  GridConfig wide;
  wide.footprint_radius_m = 0.45;
  const TextWorld world({"##########", "#........#", "#........#", "#........#", "#........#", "#........#",
                         "##########", "........##", "##########"},
                        0.25, wide);
  EXPECT_EQ(views_of(world, {4, 5}, {0, 1}, {.min_distance_m = 0.5, .max_distance_m = 2.5}).rejection,
            Rejection::kHidden);
}

TEST(Viewpoints, OneCellFrontierInADeadEnd) {
  const TextWorld world({"### ###", "#.....#", "#.....#", "#.....#", "#######"});
  const ViewpointResult result = views_of(world, {2, 2}, {3, 3});
  EXPECT_EQ(result.rejection, Rejection::kNone);
}

}  // namespace
}  // namespace lapis::planner
