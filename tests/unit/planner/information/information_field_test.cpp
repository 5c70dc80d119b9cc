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
