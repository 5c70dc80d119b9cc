#include "common/mapping/wire/tile_codec.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::mapping {
namespace {

std::set<TileIndex> tiles_of(const VoxelMap& map, int blocks_per_edge) {
  std::set<TileIndex> tiles;
  for (const BlockIndex& block : map.sorted_blocks()) tiles.insert(tile_of(block, blocks_per_edge));
  return tiles;
}

TEST(TileCodec, EdgeIsTheSmallestWholeNumberOfBlocks) {
  EXPECT_EQ(blocks_per_tile_edge(0.02, 0.8), 5);
  EXPECT_EQ(blocks_per_tile_edge(0.05, 0.8), 2);
  EXPECT_EQ(blocks_per_tile_edge(0.10, 0.8), 1);
  EXPECT_EQ(blocks_per_tile_edge(0.25, 0.8), 1);
  EXPECT_EQ(blocks_per_tile_edge(0.07, 0.8), 2);
  EXPECT_EQ(blocks_per_tile_edge(0.05, 1.6), 4);
  EXPECT_THROW(blocks_per_tile_edge(0.02, 6.4), std::runtime_error);
}

TEST(TileCodec, TilesPartitionTheBlocks) {
  for (const int edge : {1, 2, 5})
    for (int x = -11; x < 11; ++x) {
      const BlockIndex block{x, -x, 2 * x};
      const std::vector<BlockIndex> blocks = blocks_of(tile_of(block, edge), edge);
      EXPECT_EQ(blocks.size(), static_cast<std::size_t>(edge * edge * edge));
      EXPECT_TRUE(std::is_sorted(blocks.begin(), blocks.end()));
      EXPECT_EQ(std::count(blocks.begin(), blocks.end(), block), 1);
    }
}

TEST(TileCodec, RoundTripIsExact) {
  for (const std::uint32_t weight_step : {kOneVote, 1u, 100'000'000u})
    for (const int edge : {1, 2, 4}) {
      const VoxelMap map = test::random_map(7, 0.05, weight_step > 1000 ? 3 : 30, weight_step);
      VoxelMap copy(0.05);
      for (const TileIndex& tile : tiles_of(map, edge)) {
        const auto bytes = encode_tile(map, tile, edge);
        ASSERT_TRUE(bytes);
        ASSERT_LE(bytes->size(), kMaxTileBytes);
        auto decoded = decode_tile(*bytes, tile);
        ASSERT_TRUE(decoded);
        EXPECT_EQ(decoded->resolution_m, 0.05);
        EXPECT_EQ(decoded->blocks_per_edge, edge);
        for (auto& [index, block] : decoded->blocks) copy.set_block(index, std::move(block));
      }
      EXPECT_EQ(copy, map);
    }
}

TEST(TileCodec, EqualContentGivesEqualBytesWhateverItsHistory) {
  std::mt19937 random(3);
  std::vector<FrameVotes> all;
  for (int i = 0; i < 30; ++i) all.push_back(test::random_votes(random, kOneVote, 30));
  VoxelMap a(0.1), b(0.1);
  for (const FrameVotes& votes : all) a.add(votes);
  const FrameVotes extra = test::random_votes(random);
  b.add(extra);
  std::for_each(all.rbegin(), all.rend(), [&b](const FrameVotes& votes) { b.add(votes); });
  b.subtract(extra);
  for (const TileIndex& tile : tiles_of(a, 2)) EXPECT_EQ(encode_tile(a, tile, 2), encode_tile(b, tile, 2));
}

TEST(TileCodec, EmptyAndUniformBlocksAreOneWord) {
  VoxelMap map(0.25);
  EXPECT_EQ(encode_tile(map, {0, 0, 0}, 1)->size(), 12u + 1u);
  VoxelBlock uniform;
  for (int offset = 0; offset < kBlockVoxels; ++offset) uniform.add_miss(offset, 3 * kOneVote);
  map.set_block({0, 0, 0}, uniform);
  EXPECT_EQ(encode_tile(map, {0, 0, 0}, 1)->size(), 12u + 2u);
}

TEST(TileCodec, LargeTilesAreCompressedBelowTheLimit) {
  VoxelMap map(0.02);
  for (const BlockIndex& index : blocks_of({0, 0, 0}, 5)) {
    VoxelBlock block;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      block.add_miss(offset, static_cast<std::uint32_t>(offset) * 1000 + 1);
      for (std::uint16_t label = 1; label <= 6; ++label) block.add_hit(offset, label, label * 70'000u);
    }
    map.set_block(index, block);
  }
  const auto bytes = encode_tile(map, {0, 0, 0}, 5);
  ASSERT_TRUE(bytes);
  EXPECT_LE(bytes->size(), kMaxTileBytes);
  const auto decoded = decode_tile(*bytes, {0, 0, 0});
  ASSERT_TRUE(decoded);
  for (const auto& [index, block] : decoded->blocks) EXPECT_EQ(block, *map.find(index));
}

TEST(TileCodec, DamagedBytesNeverCrashAndTruncationIsAlwaysRefused) {
  const VoxelMap map = test::random_map(9);
  const TileIndex tile = *tiles_of(map, 2).begin();
  const std::vector<std::uint8_t> good = *encode_tile(map, tile, 2);
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(decode_tile(std::span(good).first(size), tile)) << size;
  std::mt19937 random(1);
  for (int trial = 0; trial < 20'000; ++trial) {
    std::vector<std::uint8_t> bad = good;
    for (int i = 0; i < 1 + trial % 8; ++i) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    const auto decoded = decode_tile(bad, {static_cast<std::int32_t>(random() % 1000), 0, -300});
    EXPECT_LE(decoded ? decoded->blocks.size() : 0u, 4096u);
  }
  for (int trial = 0; trial < 2'000; ++trial) {
    std::vector<std::uint8_t> garbage(random() % 300);
    for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random());
    if (trial % 2 == 0 && garbage.size() > 3) garbage[0] = 'L', garbage[1] = 1, garbage[2] %= 17, garbage[3] %= 2;
    decode_tile(garbage, tile);
  }
}

TEST(TileCodec, TilesBeyondAKilometreAreRefused) {
  const VoxelMap map = test::random_map(9);
  const std::vector<std::uint8_t> bytes = *encode_tile(map, *tiles_of(map, 2).begin(), 2);
  const auto farthest = static_cast<std::int32_t>(kMaxReach_m / (2 * kBlockEdge * map.resolution_m()));
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  EXPECT_TRUE(decode_tile(bytes, {farthest, -farthest, 0}));
  for (const TileIndex& far : {TileIndex{farthest + 1, 0, 0}, TileIndex{0, -farthest - 1, 0}, TileIndex{0, 0, kLeast}})
    EXPECT_FALSE(decode_tile(bytes, far)) << far.x << " " << far.y << " " << far.z;
}

TEST(TileHash, DependsOnEveryPart) {
  std::set<std::uint64_t> hashes;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -3; z <= 3; ++z)
        for (std::uint64_t version = 0; version < 8; ++version) hashes.insert(tile_hash({x, y, z}, version));
  EXPECT_EQ(hashes.size(), 7u * 7u * 7u * 8u);
}

}  // namespace
}  // namespace lapis::mapping
