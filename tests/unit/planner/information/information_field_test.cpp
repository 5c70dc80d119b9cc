#include "planner/core/information/information_field.hpp"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/planner/information/random_map.hpp"

namespace lapis::planner {
namespace {

using mapping::BlockIndex;
using mapping::VoxelBlock;
using mapping::VoxelMap;

constexpr double kFieldResolution_m = 0.25;
constexpr int kFieldClasses = 40;

InformationField empty_field() { return {kFieldResolution_m, mapping::SensorModel{}, {Measure::kSemantic}}; }

/// Blocks -2..1 along each axis: more than random_map fills.
template <class Visit>
void for_each_block(Visit&& visit) {
  for (int z = -2; z < 2; ++z)
    for (int y = -2; y < 2; ++y)
      for (int x = -2; x < 2; ++x) visit(BlockIndex{x, y, z});
}

void expect_equal(const InformationField& a, const InformationField& b) {
  for_each_block([&](const BlockIndex& index) {
    EXPECT_EQ(a.block(index).free, b.block(index).free);
    EXPECT_EQ(a.block(index).gain, b.block(index).gain);
  });
}

TEST(InformationField, HoldsTheMeasureOfEveryVoxel) {
  std::mt19937 random(1);
  const VoxelMap map = test::random_map(random, kFieldResolution_m, kFieldClasses);
  InformationField field = empty_field();
  field.rebuild(map);
  const CellMeasure measure(mapping::SensorModel{}, {Measure::kSemantic});
  for_each_block([&](const BlockIndex& index) {
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      const mapping::VoxelIndex voxel = mapping::voxel_at(index, offset);
      const CellInformation expected = measure.of(map.read(voxel)), got = field.cell(voxel);
      EXPECT_FLOAT_EQ(static_cast<float>(got.free), static_cast<float>(expected.free));
      EXPECT_FLOAT_EQ(static_cast<float>(got.gain), static_cast<float>(expected.gain));
    }
  });
}

TEST(InformationField, UpdatesOfChangedBlocksEqualARebuild) {
  std::mt19937 random(2);
  InformationField field = empty_field();
  VoxelMap map(kFieldResolution_m);
  for (int version = 0; version < 20; ++version) {
    const VoxelMap next = test::random_map(random, kFieldResolution_m, kFieldClasses);
    std::vector<BlockIndex> changed;
    for_each_block([&](const BlockIndex& index) {
      const VoxelBlock *before = map.find(index), *after = next.find(index);
      if (!before && !after) return;
      if (!before || !after || *before != *after) changed.push_back(index);
    });
    ASSERT_FALSE(changed.empty());
    map = next;
    field.update(map, changed);
    InformationField rebuilt = empty_field();
    rebuilt.rebuild(map);
    expect_equal(field, rebuilt);
  }
}

/// A third of the voxels never observed, a third seen free, a third seen occupied.
VoxelMap map_with_holes(std::mt19937& random) {
  VoxelMap map(kFieldResolution_m);
  for (int i = 0; i < 8; ++i) {
    VoxelBlock block;
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      const std::uint32_t kind = test::random_number(random, 0, 2);
      if (kind == 1) block.add_miss(offset, 3 * mapping::kOneVote);
      if (kind == 2) block.add_hit(offset, 1, 3 * mapping::kOneVote);
    }
    if (i % 3 != 0) map.set_block({(i & 1) - 1, (i >> 1 & 1) - 1, (i >> 2) - 1}, std::move(block));
  }
  return map;
}

constexpr RayModel kSurfacesGoOn{.unknown_occupied = 0.1, .surface_occupied = 0.6};

TEST(InformationField, SurfacesGoOnWhereNobodyHasLooked) {
  std::mt19937 random(4);
  const VoxelMap map = map_with_holes(random);
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  InformationField field(kFieldResolution_m, mapping::SensorModel{}, kSurfacesGoOn);
  field.rebuild(map);
  int beside = 0, away = 0;
  for (int i = 0; i < 64; ++i) {  // also blocks that the map does not have
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      const mapping::VoxelIndex v = mapping::voxel_at({(i & 3) - 2, (i >> 2 & 3) - 2, (i >> 4) - 2}, offset);
      if (map.read(v).is_observed()) continue;
      bool is_beside = false;
      for (const int step : {-1, 1}) {
        for (const mapping::VoxelIndex& n :
             {mapping::VoxelIndex{v.x + step, v.y, v.z}, {v.x, v.y + step, v.z}, {v.x, v.y, v.z + step}})
          is_beside = is_beside || reader.is_occupied(map.read(n));
      }
      EXPECT_FLOAT_EQ(static_cast<float>(field.cell(v).free), is_beside ? 0.4f : 0.9f);
      ++(is_beside ? beside : away);
    }
  }
  EXPECT_GT(beside, 100);
  EXPECT_GT(away, 50);
}

TEST(InformationField, UpdatesEqualARebuildAlsoWhereSurfacesGoOnAcrossBlocks) {
  std::mt19937 random(5);
  VoxelMap map = map_with_holes(random);
  InformationField field(kFieldResolution_m, mapping::SensorModel{}, kSurfacesGoOn);
  field.rebuild(map);
  for (int version = 0; version < 20; ++version) {
    const VoxelMap next = map_with_holes(random);
    const BlockIndex index = next.sorted_blocks()[test::random_number(random, 0, 3)];
    const bool is_gone = version % 4 == 3;
    if (is_gone) {
      map.erase_block(index);
    } else {
      map.set_block(index, *next.find(index));
    }
    field.update(map, std::vector{index});
    InformationField rebuilt(kFieldResolution_m, mapping::SensorModel{}, kSurfacesGoOn);
    rebuilt.rebuild(map);
    expect_equal(field, rebuilt);
  }
}

TEST(InformationField, RebuildForgetsWhatTheMapDoesNotHave) {
  std::mt19937 random(3);
  InformationField field = empty_field();
  field.rebuild(test::random_map(random, kFieldResolution_m, kFieldClasses));
  field.rebuild(VoxelMap(kFieldResolution_m));
  expect_equal(field, empty_field());
}

TEST(InformationField, BlocksOfEqualCellsShareOneCopy) {
  VoxelMap map(kFieldResolution_m);
  // Long since clamped, and not uniform in the map.
  for (int i = 0; i < 4; ++i) {
    VoxelBlock block(1000 * mapping::kOneVote);
    block.add_miss(17 * i, mapping::kOneVote);
    map.set_block({i, 0, 0}, std::move(block));
  }
  InformationField field = empty_field();
  field.rebuild(map);
  for (int i = 1; i < 4; ++i) EXPECT_EQ(&field.block({i, 0, 0}), &field.block({0, 0, 0}));
  EXPECT_EQ(&field.block({0, 5, 0}), &field.block({0, 0, 7})) << "unknown";
  EXPECT_NE(&field.block({0, 5, 0}), &field.block({0, 0, 0}));
}

TEST(InformationField, RefusesAMapOfAnotherResolution) {
  InformationField field = empty_field();
  EXPECT_THROW(field.rebuild(VoxelMap(0.1)), std::invalid_argument);
  EXPECT_THROW(InformationField(0.0, mapping::SensorModel{}, {Measure::kSemantic}), std::runtime_error);
}

}  // namespace
}  // namespace lapis::planner
