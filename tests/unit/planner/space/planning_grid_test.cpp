#include "planner/core/space/planning_grid.hpp"

#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using mapping::kFree;
using mapping::kOccupied;
using mapping::kUnknown;
using test::TextWorld;
using test::World;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

ObstacleGrid one_cell(const PlanningGrid& grid, Cell c, std::int8_t value) {
  return {grid.center_of(c) - 0.5 * grid.resolution_m() * Eigen::Vector2d::Ones(), grid.resolution_m(), 1, 1, {value}};
}

TEST(PlanningGrid, FollowsTheMapAndNamesWhatChanged) {
  TextWorld world({"..#", "  ."});
  EXPECT_EQ(world.known.size(), 4u);
  EXPECT_EQ(world.grid.state({0, 1}), kFree);
  EXPECT_EQ(world.grid.state({2, 1}), kOccupied);
  EXPECT_EQ(world.grid.state({0, 0}), kUnknown);
  EXPECT_EQ(world.grid.state({-100, 4000}), kUnknown);
  world.map.set({0, 0}, kFree);
  world.map.set({2, 1}, kFree);
  EXPECT_THAT(world.update(), UnorderedElementsAre(Cell{0, 0}, Cell{2, 1}));
  EXPECT_THAT(world.update(), IsEmpty());
}

TEST(PlanningGrid, ForgetsBlocksThatAreGone) {
  TextWorld world({"#."});
  world.map.set({0, 0}, kUnknown);
  world.map.set({1, 0}, kUnknown);
  EXPECT_EQ(world.update().size(), 2u);
  EXPECT_EQ(world.map.map().block_count(), 0u);
  EXPECT_EQ(world.grid.clearance_m({0, 0}), world.grid.config().max_clearance_m);
}

// Cells 0 to 2 at the bottom of the band (0.25 to 0.5 m): never seen, seen to be free, seen to be occupied. Above all
// of them the camera has looked through.
TEST(PlanningGrid, FreeAreOnlyCellsWhoseBottomHasBeenSeen) {
  constexpr std::size_t kBottom = 64, kAbove = 128;
  std::array<std::uint32_t, mapping::kBlockVoxels> misses{};
  misses[kBottom + 1] = misses[kAbove] = misses[kAbove + 1] = misses[kAbove + 2] = 3 * mapping::kOneVote;
  const mapping::HitVote hit{kBottom + 2, 1, 3 * mapping::kOneVote};
  mapping::VoxelMap map(0.25);
  map.set_block({}, mapping::VoxelBlock(misses, std::span(&hit, 1)));
  PlanningGrid grid({}, 0.25);
  grid.update_map(map, mapping::BeliefReader{mapping::SensorModel{}}, map.sorted_blocks());
  EXPECT_EQ(grid.state({0, 0}), kUnknown);
  EXPECT_EQ(grid.state({1, 0}), kFree);
  EXPECT_EQ(grid.state({2, 0}), kOccupied);
}

TEST(PlanningGrid, AnotherSensorModelLooksAtEverything) {
  World world;
  world.map.set({0, 0}, kOccupied);
  mapping::SensorModel doubtful;
  doubtful.prior_occupied = 0.001;
  doubtful.hit_gain = 0.1;
  world.map.flush();
  EXPECT_EQ(world.grid.update_map(world.map.map(), mapping::BeliefReader(doubtful), {}).size(), 1u);
  EXPECT_EQ(world.grid.state({0, 0}), kFree);
  EXPECT_THAT(world.update(), ElementsAre(Cell{0, 0}));
  EXPECT_EQ(world.grid.state({0, 0}), kOccupied);
}

TEST(PlanningGrid, TraversableIsFreeAndFarEnough) {
  constexpr int kEdge = 12;
  std::vector<std::string> rows(kEdge, std::string(kEdge, '.'));
  rows[kEdge - 1 - 5][5] = '#';
  TextWorld world(rows, 0.1);
  EXPECT_NEAR(world.grid.clearance_m({7, 6}), 0.1 * std::sqrt(5.0), 1e-12);
  EXPECT_FALSE(world.grid.is_traversable({7, 6})) << "0.22 m";
  EXPECT_TRUE(world.grid.is_traversable({7, 7})) << "0.28 m";
  EXPECT_FALSE(world.grid.is_traversable({kEdge, 8})) << "unknown";
  EXPECT_FALSE(world.grid.is_traversable({kEdge - 2, 8})) << "0.15 m from unknown space: the disc would reach into it";
  EXPECT_TRUE(world.grid.is_traversable({kEdge - 3, 8})) << "0.25 m";
}

TEST(PlanningGrid, WhereTheRobotHasStoodIsPassableUnlessSomethingIsSeenThere) {
  TextWorld world({".. .."});
  const Cell unseen{2, 0}, beside{1, 0};
  EXPECT_FALSE(world.grid.is_passable(unseen));
  world.grid.mark_driven(world.grid.center_of(unseen));
  EXPECT_TRUE(world.grid.is_passable(unseen));
  EXPECT_FALSE(world.grid.is_traversable(unseen)) << "no place to look from";
  EXPECT_EQ(world.grid.state(unseen), kUnknown) << "it may be a frontier's other side";
  EXPECT_FALSE(world.grid.is_passable({2, 1})) << "beside";
  EXPECT_FALSE(world.grid.is_passable(beside)) << "free, but the disc would reach into unknown space";
  world.grid.mark_driven(world.grid.center_of(beside));
  EXPECT_TRUE(world.grid.is_passable(beside)) << "it did";
  world.grid.update_obstacles(one_cell(world.grid, unseen, 100), {0});
  EXPECT_FALSE(world.grid.is_passable(unseen));
  EXPECT_TRUE(world.grid.is_passable(beside)) << "0.25 m";
  world.grid.update_obstacles(one_cell(world.grid, beside, 100), {0});
  EXPECT_FALSE(world.grid.is_passable(beside));
}

TEST(PlanningGrid, ObstaclesBlockAndFreeAgain) {
  TextWorld world({".....", ".....", "..#.."});
  const Cell c{1, 1};
  EXPECT_THAT(*world.grid.update_obstacles(one_cell(world.grid, c, 100), {0}), ElementsAre(c));
  EXPECT_EQ(world.grid.state(c), kOccupied);
  EXPECT_EQ(world.grid.clearance_m({1, 2}), 0.25);
  EXPECT_THAT(*world.grid.update_obstacles(one_cell(world.grid, c, 0), {1}), ElementsAre(c)) << "seen free";
  EXPECT_EQ(world.grid.state(c), kFree);
  EXPECT_GT(world.grid.clearance_m({1, 2}), 0.25);
}

TEST(PlanningGrid, ObstaclesExpireByThemselves) {
  TextWorld world({"....."});
  const time::Time seen = time::Time::from_seconds(100.0);
  ASSERT_TRUE(world.grid.update_obstacles(one_cell(world.grid, {1, 0}, 100), seen));
  const ObstacleGrid elsewhere = one_cell(world.grid, {4, 0}, 0);
  EXPECT_THAT(*world.grid.update_obstacles(elsewhere, time::Time::from_seconds(110.0)), IsEmpty());
  EXPECT_EQ(world.grid.state({1, 0}), kOccupied) << "10 s old";
  EXPECT_THAT(*world.grid.update_obstacles(elsewhere, time::Time::from_seconds(110.1)), ElementsAre(Cell{1, 0}));
  ASSERT_TRUE(world.grid.update_obstacles(one_cell(world.grid, {1, 0}, 100), seen));
  EXPECT_THAT(world.grid.expire_obstacles(time::Time::from_seconds(110.1)), ElementsAre(Cell{1, 0}));
}

TEST(PlanningGrid, ObstaclesNeverRemoveWhatTheMapSays) {
  TextWorld world({"#. "});
  ObstacleGrid all_free{{0, 0}, 0.25, 3, 1, {0, 0, 0}};
  EXPECT_THAT(*world.grid.update_obstacles(all_free, {0}), IsEmpty());
  EXPECT_EQ(world.grid.state({0, 0}), kOccupied);
  EXPECT_EQ(world.grid.state({2, 0}), kUnknown) << "the layer makes nothing known";
  ASSERT_TRUE(world.grid.update_obstacles(one_cell(world.grid, {0, 0}, 100), {0}));
  ASSERT_TRUE(world.grid.update_obstacles(all_free, {0}));
  EXPECT_EQ(world.grid.state({0, 0}), kOccupied);
  ASSERT_TRUE(world.grid.update_obstacles(one_cell(world.grid, {1, 0}, 100), {0}));
  world.map.set({1, 0}, kUnknown);
  EXPECT_THAT(world.update(), IsEmpty()) << "still an obstacle";
}

TEST(PlanningGrid, ObstaclesOfOtherCellSizesCoverEveryCellTheyTouch) {
  TextWorld world({"....", "....", "....", "...."});
  EXPECT_EQ(world.grid.update_obstacles({{0.25, 0.25}, 0.5, 1, 1, {100}}, {0})->size(), 4u);
  EXPECT_THAT(*world.grid.update_obstacles({{0.80, 0.05}, 0.1, 1, 1, {100}}, {0}), ElementsAre(Cell{3, 0}));
}

TEST(PlanningGrid, MalformedObstacleGridsAreRefused) {
  TextWorld world({"...."});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(world.grid.update_obstacles({{0, 0}, 0.25, 2, 1, {100}}, {0}));
  EXPECT_FALSE(world.grid.update_obstacles({{0, 0}, 0.0, 1, 1, {100}}, {0}));
  EXPECT_FALSE(world.grid.update_obstacles({{0, 0}, nan, 1, 1, {100}}, {0}));
  EXPECT_FALSE(world.grid.update_obstacles({{nan, 0}, 0.25, 1, 1, {100}}, {0}));
  EXPECT_FALSE(world.grid.update_obstacles({{1e12, 0}, 0.25, 1, 1, {100}}, {0}));
  EXPECT_FALSE(world.grid.update_obstacles({{0, 0}, 0.25, -1, -1, {100}}, {0}));
  EXPECT_TRUE(world.grid.update_obstacles({{0, 0}, 0.25, 0, 0, {}}, {0}));
}

TEST(PlanningGrid, MemoryGrowsWithWhatIsKnown) {
  World world(0.05);
  world.map.set({0, 0}, kFree);
  world.map.set({1999, 1999}, kFree);
  world.update();
  EXPECT_LT(world.grid.bytes(), 200'000u);
}

/// Distance to the nearest cell of a value by trying all.
double nearest_m(const World& world, Cell c, std::int8_t value, int reach) {
  double best = world.grid.config().max_clearance_m;
  for (Cell step{0, -reach}; step.y <= reach; ++step.y) {
    for (step.x = -reach; step.x <= reach; ++step.x) {
      if (world.grid.state(c + step) == value) best = std::min(best, distance(step, {}) * world.grid.resolution_m());
    }
  }
  return best;
}

class RandomGridDeltas : public testing::TestWithParam<unsigned> {};

TEST_P(RandomGridDeltas, StateChangesAndDistancesEqualThoseFromScratch) {
  World world(0.1);
  std::mt19937 random(GetParam());
  const auto number = [&random](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  constexpr int kEdge = 70;
  std::map<Cell, std::int8_t> before;
  for (int round = 0; round < 6; ++round) {
    const Cell corner{number(-kEdge, kEdge), number(-kEdge, kEdge)};
    for (int i = 0; i < 300; ++i) {
      const int kind = number(0, 9);
      world.map.set(corner + Cell{number(0, 20), number(0, 20)}, kind == 0 ? kOccupied : kind < 8 ? kFree : kUnknown);
    }
    std::vector<Cell> changed = world.update();
    const auto obstacles =
        world.grid.update_obstacles(one_cell(world.grid, corner + Cell{number(0, 20), number(0, 20)}, 100), {round});
    std::map<Cell, std::int8_t> named;
    for (const Cell& c : changed) EXPECT_TRUE(named.emplace(c, world.grid.state(c)).second) << "named twice";
    for (const Cell& c : *obstacles) named[c] = kOccupied;
    World fresh(0.1);
    fresh.grid.update_map(world.map.map(), world.reader, {});
    for (Cell c{0, -kEdge - 15}; c.y <= kEdge + 35; ++c.y) {
      for (c.x = -kEdge - 15; c.x <= kEdge + 35; ++c.x) {
        const std::int8_t state = world.grid.state(c);
        if (!before.contains(c)) before[c] = kUnknown;
        ASSERT_EQ(named.contains(c), state != before[c]) << c.x << ' ' << c.y;
        before[c] = state;
        if (fresh.grid.state(c) != kOccupied && state == kOccupied) continue;  // an obstacle
        ASSERT_EQ(state, fresh.grid.state(c));
      }
    }
    for (int i = 0; i < 300; ++i) {
      const Cell c{number(-kEdge - 15, kEdge + 35), number(-kEdge - 15, kEdge + 35)};
      const double occupied_m = nearest_m(world, c, kOccupied, 10), unknown_m = nearest_m(world, c, kUnknown, 10);
      ASSERT_NEAR(world.grid.clearance_m(c), occupied_m, 1e-12) << c.x << ' ' << c.y;
      ASSERT_EQ(world.grid.is_traversable(c),
                world.grid.state(c) == kFree && occupied_m > 0.25 - 1e-9 && unknown_m > 0.25 - 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomGridDeltas, testing::Range(0u, 20u));

}  // namespace
}  // namespace lapis::planner
