#include "semantic_mapper/core/export.hpp"

#include <cstring>
#include <memory>
#include <sstream>
#include <string>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <gtest/gtest.h>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::kOneVote;
using mapping::VoxelIndex;

struct Fixture {
  mapping::VoxelMap map{0.25};
  mapping::BeliefReader reader{mapping::SensorModel{}};
  mapping::LabelList labels = mapping::LabelList::from_names({{1, "wall"}, {7, "chair"}});

  void hit(const VoxelIndex& v, std::uint16_t label, int votes) {
    mapping::VoxelBlock block = content(v);
    block.add_hit(mapping::offset_in_block(v), label, kOneVote * static_cast<std::uint32_t>(votes));
    map.set_block(mapping::block_of(v), block);
  }
  void miss(const VoxelIndex& v, int votes) {
    mapping::VoxelBlock block = content(v);
    block.add_miss(mapping::offset_in_block(v), kOneVote * static_cast<std::uint32_t>(votes));
    map.set_block(mapping::block_of(v), block);
  }
  mapping::VoxelBlock content(const VoxelIndex& v) const {
    const mapping::VoxelBlock* block = map.find(mapping::block_of(v));
    return block ? *block : mapping::VoxelBlock{};
  }
};

Fixture small_scene() {
  Fixture f;
  // Eight siblings of one octree node, clamped to the same occupancy but of two classes: must not be merged.
  for (int i = 0; i < 8; ++i) f.hit({i & 1, i >> 1 & 1, i >> 2}, i < 4 ? 1 : 7, 1000);
  f.miss({-3, 5, 2}, 4);
  f.miss({-4, 5, 2}, 9);
  f.hit({-3, 6, 2}, 0, 5);
  return f;
}

TEST(Export, OctreeHasOneLeafPerObservedVoxelWithItsLogOddsAndColor) {
  const Fixture f = small_scene();
  std::istringstream stream([&] {
    const auto bytes = encode_octree(f.map, f.reader, f.labels).file;
    return std::string(bytes.begin(), bytes.end());
  }());
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(stream));
  auto* tree = dynamic_cast<octomap::ColorOcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  EXPECT_EQ(tree->getNumLeafNodes(), 11u);
  EXPECT_DOUBLE_EQ(tree->getResolution(), 0.25);
  f.map.for_each_observed([&](const VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    const Eigen::Vector3d p = f.map.center_of(voxel);
    const octomap::ColorOcTreeNode* node = tree->search(p.x(), p.y(), p.z());
    ASSERT_NE(node, nullptr);
    EXPECT_FLOAT_EQ(node->getLogOdds(), static_cast<float>(f.reader.occupancy_log_odds(counts)));
    if (!f.reader.is_occupied(counts)) return;
    const geometry::Rgb8 color = f.labels.color(f.reader.label(counts));
    EXPECT_EQ(node->getColor(), (octomap::ColorOcTreeNode::Color{color.r, color.g, color.b}));
  });
}

TEST(Export, OctreeMessageIsTheFileWithoutItsHeader) {
  const Fixture f = small_scene();
  const Octree octree = encode_octree(f.map, f.reader, f.labels);
  ASSERT_GT(octree.file.size(), octree.tree.size());
  EXPECT_TRUE(std::equal(octree.tree.rbegin(), octree.tree.rend(), octree.file.rbegin()));
  // As octomap_msgs reads it.
  octomap::ColorOcTree tree(0.25);
  std::istringstream stream(std::string(octree.tree.begin(), octree.tree.end()));
  tree.readData(stream);
  EXPECT_EQ(tree.getNumLeafNodes(), 11u);
}

TEST(Export, PlyHoldsTheOccupiedVoxels) {
  const Fixture f = small_scene();
  const std::vector<LabelledPoint> points = occupied_points(f.map, f.reader, f.labels);
  ASSERT_EQ(points.size(), 9u);
  const std::vector<std::uint8_t> ply = encode_ply(points);
  const std::string text(ply.begin(), ply.end());
  EXPECT_NE(text.find("element vertex 9\n"), std::string::npos);
  const std::string end = "end_header\n";
  const std::size_t data = text.find(end) + end.size();
  constexpr std::size_t kRecord = 3 * 4 + 3 + 2 + 4;
  ASSERT_EQ(ply.size() - data, 9 * kRecord);
  for (std::size_t i = 0; i < 9; ++i) {
    float x = 0, probability = 0;
    std::uint16_t label = 0;
    std::memcpy(&x, &ply[data + i * kRecord], 4);
    std::memcpy(&label, &ply[data + i * kRecord + 15], 2);
    std::memcpy(&probability, &ply[data + i * kRecord + 17], 4);
    EXPECT_EQ(x, points[i].position.x());
    EXPECT_EQ(label, points[i].label);
    EXPECT_EQ(probability, points[i].probability);
    EXPECT_GT(probability, 0.5f);
  }
}

TEST(Export, BinaryOctreeHasTheSameLeavesOccupiedOrFree) {
  const Fixture f = small_scene();
  const auto bytes = encode_binary_octree(f.map, f.reader);
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary(stream));
  EXPECT_EQ(tree.getNumLeafNodes(), 11u);
  EXPECT_DOUBLE_EQ(tree.getResolution(), 0.25);
  f.map.for_each_observed([&](const VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    const Eigen::Vector3d p = f.map.center_of(voxel);
    const octomap::OcTreeNode* node = tree.search(p.x(), p.y(), p.z());
    ASSERT_NE(node, nullptr);
    EXPECT_EQ(tree.isNodeOccupied(node), f.reader.is_occupied(counts));
  });
}

// OctoMap takes log-odds of 0 for occupied, we take them for free.
TEST(Export, AVoxelThatIsNeitherNorIsFreeInBothOctrees) {
  Fixture f;
  mapping::SensorModel model;
  model.hit_gain = 0.5;
  model.miss_gain = 0.25;
  model.prior_occupied = 0.5;
  f.reader = mapping::BeliefReader(model);
  f.hit({1, 2, 3}, 0, 1);
  f.miss({1, 2, 3}, 2);
  ASSERT_EQ(f.reader.occupancy_log_odds(f.map.read({1, 2, 3})), 0.0);
  const auto p = f.map.center_of({1, 2, 3});
  const auto full = encode_octree(f.map, f.reader, f.labels).file, binary = encode_binary_octree(f.map, f.reader);
  std::istringstream full_stream(std::string(full.begin(), full.end()));
  std::istringstream binary_stream(std::string(binary.begin(), binary.end()));
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(full_stream));
  const auto* colored = dynamic_cast<octomap::ColorOcTree*>(read.get());
  ASSERT_NE(colored, nullptr);
  EXPECT_FALSE(colored->isNodeOccupied(colored->search(p.x(), p.y(), p.z())));
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary(binary_stream));
  EXPECT_FALSE(tree.isNodeOccupied(tree.search(p.x(), p.y(), p.z())));
}

TEST(Export, EmptyMapGivesEmptyResults) {
  const Fixture f;
  EXPECT_TRUE(occupied_points(f.map, f.reader, f.labels).empty());
  EXPECT_FALSE(encode_octree(f.map, f.reader, f.labels).file.empty());
  EXPECT_FALSE(encode_binary_octree(f.map, f.reader).empty());
}

}  // namespace
}  // namespace lapis::semantic_mapper
