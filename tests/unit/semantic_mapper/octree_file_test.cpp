#include "semantic_mapper/core/octree_file.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "semantic_mapper/core/export.hpp"
#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::semantic_mapper {
namespace {

using ::testing::HasSubstr;

std::vector<std::uint8_t> to_bytes(const std::string& text) { return {text.begin(), text.end()}; }

OctreeFile read(const std::vector<std::uint8_t>& bytes) {
  std::string error;
  auto file = decode_octree(bytes, error);
  EXPECT_TRUE(file) << error;
  return file.value_or(OctreeFile{});
}

/// Free and occupied space, pruned: with leaves of many sizes.
template <class Tree>
void fill(Tree& tree) {
  for (int x = -20; x < 30; ++x)
    for (int y = -15; y < 20; ++y)
      for (int z = -4; z < 10; ++z)
        tree.updateNode(
            octomap::point3d(static_cast<float>(x + 0.5), static_cast<float>(y + 0.5), static_cast<float>(z + 0.5)) *
                0.1f,
            x * x + y * y > 150);
  tree.updateInnerOccupancy();
  tree.prune();
}

template <class Tree>
void expect_leaves_of(const Tree& tree, const OctreeFile& file) {
  EXPECT_EQ(file.nodes, tree.size());
  ASSERT_EQ(file.leaves.size(), tree.getNumLeafNodes());
  auto leaf = file.leaves.begin();
  for (auto it = tree.begin_leafs(); it != tree.end_leafs(); ++it, ++leaf) {
    const double half = 0.5 * leaf->edge_voxels;
    EXPECT_NEAR(it.getX(), (leaf->corner.x + half) * 0.1, 1e-9);
    EXPECT_NEAR(it.getY(), (leaf->corner.y + half) * 0.1, 1e-9);
    EXPECT_NEAR(it.getZ(), (leaf->corner.z + half) * 0.1, 1e-9);
    EXPECT_NEAR(it.getSize(), leaf->edge_voxels * 0.1, 1e-9);
    EXPECT_EQ(tree.isNodeOccupied(*it), leaf->is_occupied);
  }
}

TEST(OctreeFile, LeavesAreThoseThatOctomapWrote) {
  octomap::OcTree tree(0.1);
  fill(tree);
  std::ostringstream binary, full;
  tree.writeBinaryConst(binary);
  tree.write(full);
  const OctreeFile bt = read(to_bytes(binary.str())), ot = read(to_bytes(full.str()));
  EXPECT_TRUE(bt.is_binary);
  EXPECT_FALSE(ot.is_binary);
  EXPECT_EQ(ot.kind, "OcTree");
  EXPECT_DOUBLE_EQ(bt.resolution_m, 0.1);
  expect_leaves_of(tree, bt);
  expect_leaves_of(tree, ot);
}

TEST(OctreeFile, ColorsAndProbabilitiesAreRead) {
  octomap::ColorOcTree tree(0.1);
  tree.updateNode(octomap::point3d(1.05f, 2.05f, -0.35f), true)->setColor(10, 20, 30);
  std::ostringstream text;
  tree.write(text);
  const OctreeFile file = read(to_bytes(text.str()));
  ASSERT_EQ(file.leaves.size(), 1u);
  EXPECT_EQ(file.leaves[0].corner, (mapping::VoxelIndex{10, 20, -4}));
  EXPECT_EQ(file.leaves[0].color, (geometry::Rgb8{10, 20, 30}));
  EXPECT_NEAR(file.leaves[0].probability, 0.7, 1e-6);  // OctoMap's own model of a hit
}

TEST(OctreeFile, OurMapsHaveALeafPerObservedVoxel) {
  const mapping::VoxelMap map = mapping::test::random_map(5);
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  std::size_t occupied = 0, observed = 0;
  map.for_each_observed([&](const mapping::VoxelIndex&, const mapping::VoxelCounts& counts) {
    ++observed;
    occupied += reader.is_occupied(counts) ? 1 : 0;
  });
  for (const auto& bytes : {encode_octree(map, reader, {}).file, encode_binary_octree(map, reader)}) {
    const OctreeFile file = read(bytes);
    EXPECT_EQ(file.leaves.size(), observed);
    EXPECT_EQ(std::count_if(file.leaves.begin(), file.leaves.end(), [](const auto& leaf) { return leaf.is_occupied; }),
              static_cast<std::ptrdiff_t>(occupied));
  }
}

TEST(OctreeFile, EmptyTreesAreRead) {
  const mapping::VoxelMap map(0.2);
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  EXPECT_EQ(read(encode_octree(map, reader, {}).file).leaves.size(), 0u);
  EXPECT_EQ(read(encode_binary_octree(map, reader)).leaves.size(), 0u);
}

TEST(OctreeFile, DamagedFilesAreRefusedWithAReason) {
  octomap::OcTree tree(0.1);
  fill(tree);
  std::ostringstream binary, full;
  tree.writeBinaryConst(binary);
  tree.write(full);
  for (const auto& good : {to_bytes(binary.str()), to_bytes(full.str())}) {
    std::string error;
    for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 500)
      ASSERT_FALSE(decode_octree(std::span(good).first(size), error)) << size;
    auto longer = good;
    longer.push_back(0);
    EXPECT_FALSE(decode_octree(longer, error));
    EXPECT_THAT(error, HasSubstr("is damaged: the header announces"));
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {  // any outcome but a crash
      auto bad = good;
      for (int k = 0; k < 1 + i % 4; ++k) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
      error.clear();
      const bool is_read = decode_octree(bad, error).has_value();
      EXPECT_NE(is_read, !error.empty());
    }
  }
}

// A tree without end, as a chain of inner nodes: liboctomap follows it until its stack is used up.
TEST(OctreeFile, AHeaderWithoutALineAfterItIsRefused) {
  std::string error;
  EXPECT_FALSE(decode_octree(to_bytes("# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0.1\ndata"), error));
  EXPECT_THAT(error, HasSubstr("is not an OctoMap file"));
}

TEST(OctreeFile, ATreeThatIsTooDeepIsRefused) {
  std::string text = "# Octomap OcTree binary file\nid OcTree\nsize 100001\nres 0.1\ndata\n";
  for (int i = 0; i < 100000; ++i) text += std::string("\x03\x00", 2);
  std::string error;
  EXPECT_FALSE(decode_octree(to_bytes(text), error));
  EXPECT_THAT(error, HasSubstr("is damaged"));
}

TEST(OctreeFile, OtherTreesAndOtherFilesAreNamed) {
  std::string error;
  EXPECT_FALSE(decode_octree(to_bytes("# Octomap OcTree file\nid CountingOcTree\nsize 0\nres 0.1\ndata\n"), error));
  EXPECT_THAT(error, HasSubstr("'CountingOcTree'"));
  EXPECT_FALSE(decode_octree(to_bytes("ply\n"), error));
  EXPECT_THAT(error, HasSubstr("is not an OctoMap file"));
  EXPECT_FALSE(decode_octree(to_bytes("# Octomap OcTree file\nid OcTree\nsize 0\nres nan\ndata\n"), error));
  EXPECT_THAT(error, HasSubstr("resolution"));
}

}  // namespace
}  // namespace lapis::semantic_mapper
