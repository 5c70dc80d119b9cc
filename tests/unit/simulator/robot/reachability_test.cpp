#include "simulator/core/robot/reachability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "floor_plan.hpp"

namespace lapis::simulator {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

Room room(const std::string& id, const Rectangle& r) {
  return {id, "", {{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}}, 2.6};
}

TEST(RoomReach, IsTheShareThatTheCentreOfTheRobotReaches) {
  const NavMap map = map_of(6, 4, {{3.9, 0, 4.1, 4}});  // the right room is closed
  const auto reach = room_reach(map, {room("left", {0, 0, 3.9, 4}), room("right", {4.1, 0, 6, 4})}, {1, 1}, 0.2);
  ASSERT_EQ(reach.size(), 2U);
  EXPECT_NEAR(reach[0].area_m2, 3.9 * 4, 0.1);
  EXPECT_NEAR(reach[0].reachable_share, (3.9 - 0.425) * (4 - 0.45) / (3.9 * 4), 0.02);  // the border takes one cell
  EXPECT_EQ(reach[1].reachable_share, 0.0);
}

TEST(Passages, AreTheDoorsOfTheWidestPaths) {
  // a | b | c in a row with doors of 0.8 and 1.2 m, and a door of 0.5 m that leads from a to d below.
  const NavMap map = map_of(9, 6,
                            {{2.9, 3, 3.1, 4.0},
                             {2.9, 4.8, 3.1, 6},
                             {5.9, 3, 6.1, 3.5},
                             {5.9, 4.7, 6.1, 6},
                             {0, 2.9, 1, 3.1},
                             {1.5, 2.9, 9, 3.1}});
  const auto found = passages(map, {room("a", {0, 3.1, 2.9, 6}), room("b", {3.1, 3.1, 5.9, 6}),
                                    room("c", {6.1, 3.1, 9, 6}), room("d", {0, 0, 9, 2.9})});
  ASSERT_EQ(found.size(), 3U);
  const std::vector<double> widths{1.2, 0.8, 0.5};
  const std::vector<Eigen::Vector2d> places{{6, 4.1}, {3, 4.4}, {1.25, 3}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(found[i].width_m, widths[i] + 1e-3);
    EXPECT_GE(found[i].width_m, widths[i] - 0.05);
    EXPECT_LT((found[i].at - places[i]).norm(), 0.2) << found[i].at.transpose();
  }
  EXPECT_THAT((std::vector{found[0].from, found[0].to}), UnorderedElementsAre("b", "c"));
  EXPECT_THAT((std::vector{found[1].from, found[1].to}), UnorderedElementsAre("a", "b"));
  EXPECT_THAT((std::vector{found[2].from, found[2].to}), UnorderedElementsAre("a", "d"));
}

TEST(Passages, WidthIsWhereADiscJustPasses) {
  const NavMap map = map_of(4, 4, {{1.95, 0, 2.05, 1.63}, {1.95, 2.41, 2.05, 4}});
  const std::vector<Room> rooms{room("a", {0, 0, 1.95, 4}), room("b", {2.05, 0, 4, 4})};
  const auto found = passages(map, rooms);
  ASSERT_EQ(found.size(), 1U);
  const auto share = [&](double radius) { return room_reach(map, rooms, {1, 2}, radius)[1].reachable_share; };
  EXPECT_GT(share(0.5 * found[0].width_m - 1e-6), 0.0);
  EXPECT_EQ(share(0.5 * found[0].width_m + 1e-6), 0.0);
}

TEST(Passages, AreMissingWhereThereIsNoPath) {
  const NavMap map = map_of(4, 4, {{1.95, 0, 2.05, 4}});
  EXPECT_TRUE(passages(map, {room("a", {0, 0, 1.95, 4}), room("b", {2.05, 0, 4, 4})}).empty());
}

TEST(Loops, AreAsLongAsAStringAroundAPillar) {
  for (const double side : {1.0, 2.0, 3.0}) {
    const NavMap map = map_of(8, 8, {{3, 4, 3 + side, 4 + side}});
    const auto loops = find_loops(map, {}, {1, 1}, 0.3);
    ASSERT_EQ(loops.size(), 1U);
    const double string = 4 * side + 2 * std::numbers::pi * 0.3;
    EXPECT_GE(loops[0].length_m, string - 0.1);
    EXPECT_LE(loops[0].length_m, 1.08 * string + 0.1);
    EXPECT_LT((loops[0].island - Eigen::Vector2d(3 + side / 2, 4 + side / 2)).norm(), 0.05);
    EXPECT_NEAR(loops[0].island_area_m2, side * side + 4 * side * 0.3 + std::numbers::pi * 0.09, 0.1 * side + 0.1);
    EXPECT_EQ(loops[0].path.front(), loops[0].path.back());
  }
}

/// Winding number of a closed path about a point.
int winding(const Path& path, const Eigen::Vector2d& p) {
  double angle = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d a = path[i - 1] - p, b = path[i] - p;
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

TEST(Loops, TwoRingsThatShareACorridor) {
  // Two blocks with a corridor of 1.2 m around and between.
  const NavMap map = map_of(14.6, 6.4, {{1.2, 1.2, 6.2, 5.2}, {7.4, 1.2, 13.4, 5.2}});
  const std::vector<Room> rooms{room("west", {0, 0, 1.2, 6.4}), room("middle", {6.2, 0, 7.4, 6.4}),
                                room("east", {13.4, 0, 14.6, 6.4})};
  const auto loops = find_loops(map, rooms, {0.6, 0.6}, 0.2);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(loops[0].length_m, 2 * (6 + 4) + 2 * std::numbers::pi * 0.2, 0.4);
  EXPECT_NEAR(loops[1].length_m, 2 * (5 + 4) + 2 * std::numbers::pi * 0.2, 0.4);
  EXPECT_THAT(loops[0].rooms, UnorderedElementsAre("middle", "east"));
  EXPECT_THAT(loops[1].rooms, UnorderedElementsAre("west", "middle"));
  const Eigen::Vector2d first(3.7, 3.2), second(10.4, 3.2);
  EXPECT_EQ(std::abs(winding(loops[0].path, second)), 1);
  EXPECT_EQ(winding(loops[0].path, first), 0);
  EXPECT_EQ(std::abs(winding(loops[1].path, first)), 1);
  EXPECT_EQ(winding(loops[1].path, second), 0);
}

TEST(Loops, RoomsInsideABlockDoNotHideItsRing) {
  // A block of walls around a room whose door opens to the ring.
  const NavMap map = map_of(
      8, 8,
      {{1.5, 1.5, 6.5, 1.6}, {1.5, 6.4, 6.5, 6.5}, {1.5, 1.5, 1.6, 6.5}, {6.4, 1.5, 6.5, 3.5}, {6.4, 4.5, 6.5, 6.5}});
  const auto loops = find_loops(map, {}, {0.7, 0.7}, 0.2);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_NEAR(loops[0].length_m, 20 + 2 * std::numbers::pi * 0.2, 0.4);
}

TEST(Loops, ThereAreNoneAroundSmallThingsOrClosedRooms) {
  EXPECT_TRUE(find_loops(map_of(6, 6, {{3, 3, 3.3, 3.3}}), {}, {1, 1}, 0.2).empty()) << "a chair";
  EXPECT_TRUE(find_loops(map_of(6, 6, {{0, 3, 4, 4}}), {}, {1, 1}, 0.2).empty()) << "joined to the outer wall";
  EXPECT_TRUE(find_loops(map_of(6, 6, {}), {}, {0.05, 0.05}, 0.2).empty()) << "start in the wall";
}

TEST(Loops, AreThoseOfTheSpaceThatCanBeReached) {
  const NavMap map = map_of(12, 6, {{2, 2, 4, 4}, {5.9, 0, 6.1, 6}, {8, 2, 10, 4}});
  const auto loops = find_loops(map, {}, {1, 1}, 0.2);
  ASSERT_EQ(loops.size(), 1U) << "the other one lies behind a wall";
  EXPECT_LT(loops[0].island.x(), 5.0);
}

}  // namespace
}  // namespace lapis::simulator
