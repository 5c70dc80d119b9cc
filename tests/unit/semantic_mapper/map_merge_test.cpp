#include "semantic_mapper/core/map_merge.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;
using mapping::LabelList;
using mapping::MapFile;
using mapping::VoxelIndex;
using ::testing::HasSubstr;

MapFile file_of(mapping::VoxelMap map) {
  return {std::move(map), {}, LabelList::from_names({{1, "wall"}, {2, "floor"}}), {}};
}

Pose turned(const Eigen::Vector3d& axis, double degrees, const Eigen::Vector3d& translation) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(degrees * M_PI / 180.0, axis.normalized()).toRotationMatrix();
  T.translation() = translation;
  return T;
}

std::string reason_of_refusal(MapFile sum, const MapFile& other) {
  const mapping::VoxelMap before = sum.map;
  try {
    merge_into(sum, other, Pose::Identity());
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(sum.map, before);
    return error.what();
  }
  return "nothing was thrown";
}

TEST(MapMerge, InOneFrameEqualsTheJointBuild) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    mapping::VoxelMap a(0.1), b(0.1), joint(0.1);
    for (int i = 0; i < 20; ++i) {
      const auto votes = mapping::test::random_votes(random, 77);
      (i % 2 ? a : b).add(votes);
      joint.add(votes);
    }
    MapFile sum = file_of(a);
    merge_into(sum, file_of(b), Pose::Identity());
    EXPECT_EQ(sum.map, joint);
  }
}

// Turning the merged map back gives the other map again: no voxel is lost, doubled or changed.
TEST(MapMerge, QuarterTurnsAndWholeVoxelsAreExact) {
  const MapFile other = file_of(mapping::test::random_map(3));
  const std::vector<Pose> poses{turned({0, 0, 1}, 90, {1.7, -2.3, 0.4}), turned({0, 0, 1}, -180, {10, 0, 0}),
                                turned({1, 0, 0}, 270, {0.1, 0.2, 0.3}), turned({1, 1, 1}, 120, {-100.1, 3.0, 1.0})};
  for (const Pose& T : poses) {
    ASSERT_TRUE(is_on_grid(T, 0.1));
    MapFile there = file_of(mapping::VoxelMap(0.1));
    merge_into(there, other, T);
    EXPECT_FALSE(there.map == other.map);
    other.map.for_each_observed([&](const VoxelIndex& v, const mapping::VoxelCounts& counts) {
      ASSERT_EQ(there.map.read(there.map.index_of(T * other.map.center_of(v))), counts);
    });
    MapFile returned = file_of(mapping::VoxelMap(0.1));
    merge_into(returned, there, T.inverse());
    EXPECT_EQ(returned.map, other.map);
  }
}

TEST(MapMerge, OffTheGridAWallHasNoHolesAndMovesByLessThanAVoxel) {
  MapFile wall = file_of(mapping::VoxelMap(0.1));
  for (std::int32_t y = -20; y < 20; ++y) {
    for (std::int32_t z = 0; z < 20; ++z) {
      const VoxelIndex v{5, y, z};
      const auto* old = wall.map.find(mapping::block_of(v));
      mapping::VoxelBlock block = old != nullptr ? *old : mapping::VoxelBlock{};
      block.add_hit(mapping::offset_in_block(v), 1, 5 * mapping::kOneVote);
      wall.map.set_block(mapping::block_of(v), block);
    }
  }
  const Pose T = turned({0.1, 0.05, 1.0}, 33.0, {0.234, -0.567, 0.05});
  EXPECT_FALSE(is_on_grid(T, 0.1));
  MapFile sum = file_of(mapping::VoxelMap(0.1));
  merge_into(sum, wall, T);
  sum.map.for_each_observed([&](const VoxelIndex& v, const mapping::VoxelCounts&) {
    EXPECT_LE(std::abs((T.inverse() * sum.map.center_of(v)).x() - 0.55), 0.05 + 1e-9);
  });
  // Of two voxels that share a face and lie on either side of the wall's middle one is wall: no ray gets through.
  const auto in_wall = [&](const VoxelIndex& v) -> Eigen::Vector3d { return T.inverse() * sum.map.center_of(v); };
  int pairs = 0;
  sum.map.for_each_observed([&](const VoxelIndex& near, const mapping::VoxelCounts&) {
    for (std::int32_t i = 0; i < 27; ++i) {
      const VoxelIndex a{near.x + i % 3 - 1, near.y + i / 3 % 3 - 1, near.z + i / 9 - 1};
      for (const VoxelIndex& b : {VoxelIndex{a.x + 1, a.y, a.z}, {a.x, a.y + 1, a.z}, {a.x, a.y, a.z + 1}}) {
        const Eigen::Vector3d p = in_wall(a), q = in_wall(b);
        const bool is_inside = std::abs(p.y()) < 1.8 && p.z() > 0.2 && p.z() < 1.8;
        if (!is_inside || (p.x() - 0.55) * (q.x() - 0.55) >= 0.0) continue;
        ++pairs;
        ASSERT_TRUE(sum.map.read(a).is_observed() || sum.map.read(b).is_observed());
      }
    }
  });
  EXPECT_GT(pairs, 1000);
}

TEST(MapMerge, UnitesTheClasses) {
  MapFile sum = file_of(mapping::VoxelMap(0.1)), other = sum;
  other.labels = LabelList::from_names({{2, "floor"}, {50, "lamp"}});
  other.sensor_model.class_count = 50;
  merge_into(sum, other, Pose::Identity());
  EXPECT_EQ(sum.labels.size(), 3u);
  EXPECT_EQ(sum.labels.name(50), "lamp");
  EXPECT_EQ(sum.sensor_model.class_count, 50);
}

TEST(MapMerge, OfMapsMadeOtherwiseNobodyKnowsHowFramesEntered) {
  MapFile sum = file_of(mapping::VoxelMap(0.1)), other = sum;
  sum.frames = other.frames = mapping::FrameSettings{};
  merge_into(sum, other, Pose::Identity());
  EXPECT_EQ(sum.frames, other.frames);
  other.frames->stride = 4;
  merge_into(sum, other, Pose::Identity());
  EXPECT_FALSE(sum.frames);
}

TEST(MapMerge, RefusesWhatDoesNotBelongTogether) {
  const MapFile a = file_of(mapping::test::random_map(1));
  EXPECT_THAT(reason_of_refusal(a, file_of(mapping::VoxelMap(0.2))), HasSubstr("build all maps at one resolution"));
  MapFile other = a;
  other.labels = LabelList::from_names({{1, "chair"}});
  EXPECT_THAT(reason_of_refusal(a, other), HasSubstr("class 1 is 'wall' in one label list and 'chair' in the other"));
  other = a;
  other.sensor_model = mapping::paper_sensor_model();
  EXPECT_THAT(reason_of_refusal(a, other), HasSubstr("prior shares"));
  other = a;
  other.sensor_model.fusion = "bki";
  EXPECT_THAT(reason_of_refusal(a, other), HasSubstr("fused by bki, the maps before by log_odds"));
  MapFile full = file_of(mapping::VoxelMap(0.1));
  mapping::VoxelBlock block;
  block.add_hit(7, 1, 0xffffff00u);
  full.map.set_block({0, 0, 0}, block);
  EXPECT_THAT(reason_of_refusal(full, full), HasSubstr("more votes in a voxel than 32 bits hold"));
}

}  // namespace
}  // namespace lapis::semantic_mapper
