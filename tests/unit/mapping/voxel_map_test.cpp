#include "common/mapping/model/voxel_map.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "common/mapping/wire/frame_codec.hpp"
#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::mapping {
namespace {

using test::random_votes;

/// The plainest possible map: what VoxelMap must agree with.
struct ReferenceMap {
  std::map<VoxelIndex, std::uint64_t> misses;
  std::map<VoxelIndex, std::map<int, std::uint64_t>> hits;
  void add(const FrameVotes& votes) {
    for (const BlockVotes& block : votes.blocks) {
      for (int offset = 0; offset < kBlockVoxels; ++offset)
        if (block.misses[static_cast<std::size_t>(offset / 64)] >> (offset % 64) & 1u)
          misses[voxel_at(block.block, offset)] += kOneVote;
      for (std::uint32_t i = block.hits_begin; i < block.hits_end; ++i)
        hits[voxel_at(block.block, votes.hits[i].offset)][votes.hits[i].label] += votes.hits[i].weight;
    }
  }
};

std::vector<FrameVotes> many_votes(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::vector<FrameVotes> all;
  for (int i = 0; i < count; ++i) all.push_back(random_votes(random, i % 3 == 0 ? 17 : kOneVote, 40));
  return all;
}

TEST(VoxelIndex, OffsetsAndBlocksCoverNegativeCells) {
  for (int x = -20; x < 20; ++x)
    for (int z = -9; z < 9; ++z) {
      const VoxelIndex voxel{x, -x, z};
      const int offset = offset_in_block(voxel);
      ASSERT_GE(offset, 0);
      ASSERT_LT(offset, kBlockVoxels);
      EXPECT_EQ(voxel_at(block_of(voxel), offset), voxel);
    }
}

TEST(VoxelMap, VoxelCoversHalfOpenCellFromOrigin) {
  const VoxelMap map(0.25);
  EXPECT_EQ(map.index_of({0.0, 0.249, 0.25}), (VoxelIndex{0, 0, 1}));
  EXPECT_EQ(map.index_of({-0.001, -0.25, -0.251}), (VoxelIndex{-1, -1, -2}));
  EXPECT_TRUE(map.center_of({-1, 0, 2}).isApprox(Eigen::Vector3d(-0.125, 0.125, 0.625)));
}

TEST(VoxelMap, RefusesResolutionOutOfRange) {
  EXPECT_THROW(VoxelMap(0.019), std::runtime_error);
  EXPECT_THROW(VoxelMap(0.51), std::runtime_error);
}

TEST(VoxelMap, EqualsPlainReferenceSums) {
  VoxelMap map(0.1);
  ReferenceMap reference;
  for (const FrameVotes& votes : many_votes(1, 60)) {
    map.add(votes);
    reference.add(votes);
  }
  std::size_t observed = 0;
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts& counts) {
    ++observed;
    EXPECT_EQ(counts.misses, reference.misses[voxel]);
    ASSERT_EQ(counts.hits.size(), reference.hits[voxel].size());
    auto expected = reference.hits[voxel].begin();
    for (const ClassCount& hit : counts.hits) {
      EXPECT_EQ(hit.label, expected->first);
      EXPECT_EQ(hit.count, expected->second);
      ++expected;
    }
  });
  std::set<VoxelIndex> expected;
  for (const auto& [voxel, count] : reference.misses)
    if (count > 0) expected.insert(voxel);
  for (const auto& [voxel, classes] : reference.hits)
    if (!classes.empty()) expected.insert(voxel);
  EXPECT_EQ(observed, expected.size());
}

TEST(VoxelMap, OrderOfFramesDoesNotMatter) {
  std::vector<FrameVotes> all = many_votes(2, 40);
  VoxelMap forward(0.1), shuffled(0.1);
  for (const FrameVotes& votes : all) forward.add(votes);
  std::shuffle(all.begin(), all.end(), std::mt19937(3));
  for (const FrameVotes& votes : all) shuffled.add(votes);
  EXPECT_EQ(forward, shuffled);
}

TEST(VoxelMap, AddThenSubtractLeavesNothing) {
  std::vector<FrameVotes> all = many_votes(4, 40);
  VoxelMap map(0.1);
  for (const FrameVotes& votes : all) map.add(votes);
  std::shuffle(all.begin(), all.end(), std::mt19937(5));
  for (std::size_t i = 0; i < all.size(); ++i) {
    map.subtract(all[i]);
    VoxelMap rest(0.1);
    for (std::size_t j = i + 1; j < all.size(); ++j) rest.add(all[j]);
    ASSERT_EQ(map, rest) << "after taking out " << i + 1 << " frames";
  }
  EXPECT_EQ(map.block_count(), 0u);
}

TEST(FrameVotes, PackedVotesUnpackToTheSame) {
  for (const FrameVotes& votes : many_votes(7, 20)) EXPECT_EQ(unpack_votes(pack(votes)), votes);
  EXPECT_EQ(unpack_votes(pack(FrameVotes{})), FrameVotes{});
}

TEST(FrameVotes, WithoutWhatIsCommonTheyMakeTheSameMap) {
  std::mt19937 random(8);
  for (const FrameVotes& before : many_votes(9, 40)) {
    FrameVotes after = random() % 3 == 0 ? random_votes(random, kOneVote, 3) : before;
    for (BlockVotes& block : after.blocks) block.misses[random() % 8] ^= random();
    for (HitVote& hit : after.hits) hit.label = static_cast<std::uint16_t>(hit.label + (random() % 4 == 0 ? 1 : 0));
    VoxelMap map(0.1), expected(0.1);
    map.add(before);
    expected.add(after);
    FrameVotes gone = before, come = after;
    drop_common(gone, come);
    for (const BlockVotes& a : gone.blocks)
      for (const BlockVotes& b : come.blocks)
        for (std::size_t i = 0; i < a.misses.size(); ++i)
          EXPECT_TRUE(!(a.block == b.block) || (a.misses[i] & b.misses[i]) == 0);
    map.subtract(gone);
    map.add(come);
    ASSERT_EQ(map, expected);
    FrameVotes same = before;
    gone = before;
    drop_common(gone, same);
    EXPECT_TRUE(gone.blocks.empty() && same.hits.empty());
  }
}

TEST(VoxelMap, SubtractingWhatIsNotThereIsABug) {
  const std::vector<FrameVotes> all = many_votes(6, 2);
  VoxelMap map(0.1);
  map.add(all[0]);
  EXPECT_THROW(map.subtract(all[1]), std::logic_error);
}

TEST(VoxelMap, ManyClassesInOneVoxelAreAllKept) {
  VoxelBlock block;
  for (int label = 300; label > 0; --label) block.add_hit(511, static_cast<std::uint16_t>(label), 256);
  VoxelCounts counts;
  block.read(511, counts);
  ASSERT_EQ(counts.hits.size(), 300u);
  EXPECT_TRUE(std::is_sorted(counts.hits.begin(), counts.hits.end(),
                             [](const ClassCount& a, const ClassCount& b) { return a.label < b.label; }));
  for (int label = 1; label <= 300; ++label) {
    const HitVote vote{511, static_cast<std::uint16_t>(label), 256};
    EXPECT_TRUE(block.subtract({}, {&vote, 1}));
  }
  EXPECT_TRUE(block.is_empty());
}

/// Counts of one byte, two and four, parts of votes and numbers for whole blocks, in any order.
TEST(MissCounts, EqualPlainSumsInEveryForm) {
  std::mt19937 random(9);
  const auto number = [&random](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  for (int trial = 0; trial < 40; ++trial) {
    MissCounts counts;
    std::array<std::uint32_t, kBlockVoxels> plain{};
    std::vector<BlockMask> added;
    for (int step = 0; step < 700; ++step) {
      BlockMask mask;
      for (std::uint64_t& word : mask)
        word = trial % 2 == 0 ? random() * std::uint64_t{0x100000001} : ~std::uint64_t{0};
      if (number(0, 99) == 0) mask[static_cast<std::size_t>(number(0, 7))] ^= 1;
      counts.add_votes(mask);
      added.push_back(mask);
      for (std::size_t i = 0; i < kBlockVoxels; ++i) plain[i] += (mask[i / 64] >> i % 64 & 1u) != 0 ? kOneVote : 0;
      if (trial % 5 != 0 || number(0, 99) > 0) continue;
      const int offset = number(0, kBlockVoxels - 1);
      const auto weight = static_cast<std::uint32_t>(trial % 3 == 0 ? number(1, 600) : 70000 * 256);
      counts.add(offset, weight);
      plain[static_cast<std::size_t>(offset)] += weight;
    }
    MissCounts copy(counts);
    for (int offset = 0; offset < kBlockVoxels; ++offset)
      ASSERT_EQ(copy.at(offset), plain[static_cast<std::size_t>(offset)]) << trial;
    for (const BlockMask& mask : added) {
      ASSERT_TRUE(counts.subtract_votes(mask));
      for (std::size_t i = 0; i < kBlockVoxels; ++i) plain[i] -= (mask[i / 64] >> i % 64 & 1u) != 0 ? kOneVote : 0;
    }
    for (int offset = 0; offset < kBlockVoxels; ++offset)
      ASSERT_EQ(counts.at(offset), plain[static_cast<std::size_t>(offset)]) << trial;
    EXPECT_FALSE(counts == copy);
  }
}

TEST(MissCounts, TakingOutWhatIsNotThereIsReportedInEveryForm) {
  const BlockMask one{1};
  EXPECT_FALSE(MissCounts().subtract_votes(one));
  for (const std::uint32_t weight : {kOneVote, 300 * kOneVote, 70000 * kOneVote, 7u}) {
    MissCounts counts;
    counts.add(5, weight);
    EXPECT_FALSE(counts.subtract_votes(one)) << weight;
  }
}

TEST(VoxelBlock, OfAllCountsAtOnceEqualsTheSumInTheFewestBytes) {
  struct Case {
    std::uint32_t unit, most;
    std::size_t bytes_per_voxel;
  };
  for (const Case& c :
       {Case{kOneVote, 1, 0}, {kOneVote, 255, 1}, {kOneVote, 60'000, 2}, {kOneVote, 70'000, 4}, {1, 9, 4}}) {
    std::mt19937 random(c.most);
    std::array<std::uint32_t, kBlockVoxels> misses{};
    std::vector<HitVote> hits;
    VoxelBlock expected;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const std::uint32_t count =
          c.unit * (c.most == 1 || offset == 7 ? c.most : static_cast<std::uint32_t>(random() % (c.most + 1)));
      misses[static_cast<std::size_t>(offset)] = count;
      expected.add_miss(offset, count);
      for (auto label = static_cast<std::uint16_t>(random() % 3); label < 2; ++label) {
        hits.push_back({static_cast<std::uint16_t>(offset), label, 1 + static_cast<std::uint32_t>(offset) * kOneVote});
        expected.add_hit(offset, label, hits.back().weight);
      }
    }
    EXPECT_EQ(VoxelBlock(misses, hits), expected) << c.most;
    EXPECT_EQ(MissCounts(misses).heap_bytes(), c.bytes_per_voxel * kBlockVoxels) << c.most;
    EXPECT_TRUE(VoxelBlock({}, {}).is_empty());
  }
}

/// Known free space: a building of 10^8 voxels that two hundred frames have looked through.
TEST(VoxelMap, HundredMillionFreeVoxelsTakeFewBytes) {
  constexpr int kEdge = 58;  // blocks
  VoxelMap map(0.05);
  FrameVotes votes;
  for (int z = 0; z < kEdge; ++z)
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        votes.blocks.push_back({{x, y, z}, {}, 0, 0});
        votes.blocks.back().misses.fill(~std::uint64_t{0});
      }
  for (int frame = 0; frame < 20; ++frame) map.add(votes);
  const double voxels = std::pow(kEdge * kBlockEdge, 3);
  EXPECT_GT(voxels, 99.8e6);
  std::cout << "uniform blocks: " << static_cast<double>(map.bytes()) / voxels << " bytes per voxel\n";
  EXPECT_LT(map.bytes(), 20'000'000u);
  EXPECT_EQ(map.read({1, 2, 3}).misses, 20 * kOneVote);
  VoxelMap torn(0.05);  // the same when every block has one voxel less
  for (BlockVotes& block : votes.blocks) block.misses[3] = 1;
  for (int frame = 0; frame < 3; ++frame) torn.add(votes);
  std::cout << "one byte per voxel: " << static_cast<double>(torn.bytes()) / voxels << " bytes per voxel\n";
  EXPECT_LT(torn.bytes(), 125'000'000u);
}

TEST(VoxelMap, UnknownVoxelReadsAsNeverObserved) { EXPECT_FALSE(VoxelMap(0.25).read({3, -7, 12}).is_observed()); }

}  // namespace
}  // namespace lapis::mapping
