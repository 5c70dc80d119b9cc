#include "planner/core/space/frontier_map.hpp"

#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"
#include "tests/unit/planner/space/frontier_rescan.hpp"

namespace lapis::planner {
namespace {

using mapping::kFree;
using mapping::kOccupied;
using mapping::kUnknown;
using test::TextWorld;
using test::World;
using testing::ElementsAre;

FrontierMap frontiers_of(const TextWorld& world, const FrontierConfig& config = {}) {
  FrontierMap map(config);
  map.update(world.grid, world.known);
  return map;
}

std::vector<std::vector<Cell>> groups_of(const FrontierMap& map) {
  std::vector<std::vector<Cell>> groups;
  for (const auto& [id, frontier] : map.frontiers()) groups.push_back(frontier.cells);
  std::sort(groups.begin(), groups.end());
  return groups;
}

TEST(FrontierMap, ClosedRoomHasNone) {
  EXPECT_TRUE(frontiers_of(TextWorld({"####", "#..#", "#..#", "####"})).frontiers().empty());
}

TEST(FrontierMap, OfAnEmptyGridIsEmpty) {
  FrontierMap map({});
  map.update(World().grid, {});
  EXPECT_TRUE(map.frontiers().empty());
}

TEST(FrontierMap, OneCellCounts) {
  const FrontierMap map = frontiers_of(TextWorld({"## ##", "#...#", "#####"}));
  ASSERT_EQ(map.frontiers().size(), 1u);
  const Frontier& frontier = map.frontiers().begin()->second;
  EXPECT_THAT(frontier.cells, ElementsAre(Cell{2, 1}));
  EXPECT_THAT(frontier.representatives, ElementsAre(Cell{2, 1}));
  EXPECT_EQ(frontier.centroid_map, Eigen::Vector2d(0.625, 0.375));
  EXPECT_EQ(frontier.length_m, 0.25);
  EXPECT_NEAR(frontier.extent_m, 0.25 * std::sqrt(2.0), 1e-12);
}

TEST(FrontierMap, DiagonalGapsAreNone) {
  EXPECT_TRUE(frontiers_of(TextWorld({"### ", "#..#", "#..#", "####"})).frontiers().empty());
}

TEST(FrontierMap, UnreachableOnesAreListedToo) {
  const FrontierMap map = frontiers_of(TextWorld({"#### ", "#..#.", "#..#.", "#### "}));
  EXPECT_THAT(groups_of(map), ElementsAre(ElementsAre(Cell{4, 1}, Cell{4, 2})));
}

TEST(FrontierMap, LongOnesAreSplit) {
  const TextWorld world({std::string(40, ' '), std::string(40, '.'), std::string(40, '#')});
  const FrontierMap map = frontiers_of(world, {.max_extent_m = 2.0});
  std::set<Cell> cells;
  for (const auto& [id, frontier] : map.frontiers()) {
    EXPECT_LE(frontier.extent_m, 2.0);
    EXPECT_GT(frontier.extent_m, 1.0) << "not into crumbs";
    EXPECT_EQ(frontier.representatives.size(), 3u);
    cells.insert(frontier.cells.begin(), frontier.cells.end());
  }
  EXPECT_EQ(map.frontiers().size(), 8u) << "halves of halves: 10 m, 5 m, 2.5 m, 1.25 m";
  EXPECT_EQ(cells.size(), 40u);
}

TEST(FrontierMap, RepresentativesAreTheMiddleAndTheEnds) {
  const FrontierMap map = frontiers_of(TextWorld({"       ", ".......", "#######"}));
  EXPECT_THAT(map.frontiers().begin()->second.representatives, ElementsAre(Cell{3, 1}, Cell{0, 1}, Cell{6, 1}));
}

TEST(FrontierMap, IdsLiveOnWhereCellsAreShared) {
  TextWorld world({"     ##     ", ".....##.....", "############"});
  FrontierMap map = frontiers_of(world);
  ASSERT_EQ(map.frontiers().size(), 2u);
  world.map.set({0, 2}, kOccupied);
  map.update(world.grid, world.update());
  ASSERT_EQ(map.frontiers().size(), 2u);
  EXPECT_EQ(map.frontiers().at(1).cells.size(), 5u) << "cell (0, 1) still has an unknown one on its left";
  world.map.set({-1, 1}, kOccupied);
  map.update(world.grid, world.update());
  EXPECT_EQ(map.frontiers().at(1).cells.size(), 4u);
  EXPECT_EQ(map.frontiers().at(2).cells.size(), 5u) << "untouched";
}

TEST(FrontierMap, TheLargerPartKeepsTheIdAndNoIdIsUsedTwice) {
  TextWorld world({"     ", ".....", "#####"});
  FrontierMap map = frontiers_of(world);
  ASSERT_TRUE(map.frontiers().contains(1));
  world.map.set({1, 2}, kOccupied);
  world.map.set({1, 1}, kOccupied);
  map.update(world.grid, world.update());
  ASSERT_EQ(map.frontiers().size(), 2u);
  EXPECT_EQ(map.frontiers().at(1).cells.size(), 3u);
  EXPECT_THAT(map.frontiers().at(2).cells, ElementsAre(Cell{0, 1}));
  world.map.set({1, 1}, kFree);
  world.map.set({1, 2}, kFree);
  map.update(world.grid, world.update());
  ASSERT_EQ(map.frontiers().size(), 1u) << "joined again";
  EXPECT_TRUE(map.frontiers().contains(1));
  world.map.set({1, 1}, kOccupied);
  world.map.set({1, 2}, kOccupied);
  map.update(world.grid, world.update());
  EXPECT_TRUE(map.frontiers().contains(1));
  EXPECT_TRUE(map.frontiers().contains(3)) << "2 was used";
}

class RandomFrontierDeltas : public testing::TestWithParam<unsigned> {};

TEST_P(RandomFrontierDeltas, UpdatedEqualsRescan) {
  constexpr int kEdge = 60;
  World world(0.1);
  const FrontierConfig config{.max_extent_m = 1.3};
  FrontierMap map(config);
  geometry::Image<std::int8_t> states(kEdge, kEdge, kUnknown);
  std::mt19937 random(GetParam());
  const auto number = [&random](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const int most_edge = GetParam() % 2 == 0 ? 25 : 4;
  for (int round = 0; round < 40; ++round) {
    for (int patch = 0; patch < 3; ++patch) {
      const Cell low{number(1, kEdge - 2), number(1, kEdge - 2)};
      const int width = number(1, most_edge), height = number(1, most_edge), kind = number(0, 9);
      const std::int8_t value = kind < 2 ? kOccupied : kind < 8 ? kFree : kUnknown;
      for (int y = low.y; y < std::min(low.y + height, kEdge - 1); ++y)
        for (int x = low.x; x < std::min(low.x + width, kEdge - 1); ++x) world.map.set({x, y}, value);
    }
    const std::vector<Cell> changed = world.update();
    for (const Cell& c : changed) states(c.x, c.y) = world.grid.state(c);
    map.update(world.grid, changed);
    ASSERT_EQ(groups_of(map), test::FrontierRescan(states, config.max_extent_m / 0.1).groups) << "round " << round;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomFrontierDeltas, testing::Range(0u, 60u));

}  // namespace
}  // namespace lapis::planner
