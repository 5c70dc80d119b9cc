#include "semantic_mapper/core/floor_plan.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::kOneVote;
using mapping::VoxelIndex;

bool is_equal(const OccupancyGrid& a, const OccupancyGrid& b) {
  return a.resolution_m == b.resolution_m && a.origin_x_m == b.origin_x_m && a.origin_y_m == b.origin_y_m &&
         a.width == b.width && a.height == b.height && a.cells == b.cells;
}

void add(mapping::VoxelMap& map, const VoxelIndex& v, int hits, int misses) {
  const auto* old = map.find(mapping::block_of(v));
  mapping::VoxelBlock block = old != nullptr ? *old : mapping::VoxelBlock{};
  block.add_hit(mapping::offset_in_block(v), 1, kOneVote * static_cast<std::uint32_t>(hits));
  block.add_miss(mapping::offset_in_block(v), kOneVote * static_cast<std::uint32_t>(misses));
  map.set_block(mapping::block_of(v), block);
}

/// The rule as it is written down, voxel by voxel.
OccupancyGrid plan_of(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                      const mapping::HeightBand& config) {
  std::vector<GridCell> cells;
  map.for_each_observed([&](const VoxelIndex& v, const mapping::VoxelCounts& counts) {
    const double height_m = (v.z + 0.5) * map.resolution_m();
    if (height_m < config.min_height_m || height_m >= config.max_height_m) return;
    cells.push_back({v.x, v.y, reader.is_occupied(counts) ? kOccupied : kFree});
  });
  return make_grid(cells, map.resolution_m());
}

TEST(FloorPlan, ColumnIsOccupiedThenFreeThenUnknown) {
  mapping::VoxelMap map(0.25);
  add(map, {2, 3, 1}, 0, 3);
  add(map, {2, 3, 2}, 0, 3);
  add(map, {2, 3, 3}, 3, 0);  // occupied above free: occupied
  add(map, {4, 3, 2}, 0, 3);  // free only
  add(map, {4, 3, 0}, 9, 0);  // floor: below the band
  add(map, {4, 3, 9}, 9, 0);  // ceiling: above the band
  add(map, {9, 9, 0}, 9, 0);  // outside the band: does not extend the grid
  FloorPlan plan({0.2, 1.2});
  const OccupancyGrid grid = plan.project(map, mapping::BeliefReader{mapping::SensorModel{}});
  EXPECT_EQ(grid.width, 3);
  EXPECT_EQ(grid.height, 1);
  EXPECT_DOUBLE_EQ(grid.origin_x_m, 0.5);
  EXPECT_DOUBLE_EQ(grid.origin_y_m, 0.75);
  EXPECT_EQ(grid.cells, (std::vector<std::int8_t>{kOccupied, kUnknown, kFree}));
}

TEST(FloorPlan, OfAnEmptyMapIsEmpty) {
  const mapping::VoxelMap map(0.25);
  FloorPlan plan({});
  EXPECT_TRUE(plan.project(map, mapping::BeliefReader{mapping::SensorModel{}}).cells.empty());
}

TEST(FloorPlan, UpdatedEqualsProjectedAnewWhateverChanges) {
  const mapping::HeightBand band{-0.33, 0.71};  // begins and ends inside blocks
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    mapping::VoxelMap map(0.1);
    std::vector<mapping::FrameVotes> inside;
    FloorPlan plan(band);
    for (int step = 0; step < 30; ++step) {
      const bool takes_out = !inside.empty() && random() % 3 == 0;
      const auto votes = takes_out ? inside.back() : mapping::test::random_votes(random);
      takes_out ? map.subtract(votes) : map.add(votes);
      takes_out ? inside.pop_back() : inside.push_back(votes);
      std::vector<mapping::BlockIndex> blocks;
      for (const auto& of_block : votes.blocks) blocks.push_back(of_block.block);
      plan.mark_changed(blocks);
      if (step % 3 != 0) continue;
      ASSERT_TRUE(is_equal(plan.project(map, reader), plan_of(map, reader, band))) << step;
    }
    while (!inside.empty()) {
      map.subtract(inside.back());
      std::vector<mapping::BlockIndex> blocks;
      for (const auto& of_block : inside.back().blocks) blocks.push_back(of_block.block);
      plan.mark_changed(blocks);
      inside.pop_back();
    }
    EXPECT_TRUE(plan.project(map, reader).cells.empty()) << "nothing is left of what was taken out";
  }
}

TEST(FloorPlan, AnotherSensorModelProjectsEverythingAgain) {
  mapping::VoxelMap map(0.25);
  add(map, {0, 0, 2}, 1, 0);
  FloorPlan plan({});
  mapping::SensorModel model;
  model.prior_occupied = 0.1;
  const mapping::BeliefReader doubtful(model);
  model.prior_occupied = 0.5;
  const mapping::BeliefReader sure(model);
  EXPECT_EQ(plan.project(map, doubtful).cells, std::vector<std::int8_t>{kFree});
  EXPECT_EQ(plan.project(map, sure).cells, std::vector<std::int8_t>{kOccupied});
}

}  // namespace
}  // namespace lapis::semantic_mapper
