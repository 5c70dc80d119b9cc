#include "common/mapping/wire/map_mirror.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::mapping {
namespace {

constexpr double kResolution_m = 0.1;
constexpr int kTileEdge = 2;

/// The publishing side, reduced to its promise: versions of tiles and a state after them.
class MapPublisher {
 public:
  struct Tile {
    TileIndex index;
    std::uint64_t version;
    std::vector<std::uint8_t> bytes;
  };
  explicit MapPublisher(std::int64_t epoch, double resolution_m = kResolution_m) : epoch_(epoch), map_(resolution_m) {}

  std::vector<Tile> publish(const FrameVotes& votes) {
    map_.add(votes);
    ++version_;
    std::set<TileIndex> changed;
    for (const BlockVotes& block : votes.blocks) changed.insert(tile_of(block.block, kTileEdge));
    std::vector<Tile> tiles;
    for (const TileIndex& index : changed) {
      versions_[index] = version_;
      tiles.push_back({index, version_, *encode_tile(map_, index, kTileEdge)});
    }
    return tiles;
  }
  MapState state() const {
    MapState state{epoch_, version_, static_cast<std::uint32_t>(versions_.size()), 0, map_.resolution_m()};
    for (const auto& [index, version] : versions_) state.checksum += tile_hash(index, version);
    return state;
  }
  const VoxelMap& map() const { return map_; }
  std::int64_t epoch() const { return epoch_; }

 private:
  std::int64_t epoch_;
  VoxelMap map_;
  std::uint64_t version_ = 0;
  std::map<TileIndex, std::uint64_t> versions_;
};

TEST(MapMirror, ServesEachVersionOnceItsTilesAreThere) {
  std::mt19937 random(1);
  MapPublisher publisher(5);
  MapMirror mirror;
  EXPECT_EQ(mirror.map(), nullptr);
  for (int i = 0; i < 10; ++i) {
    for (const auto& tile : publisher.publish(test::random_votes(random)))
      EXPECT_EQ(mirror.apply_tile(5, tile.index, tile.version, tile.bytes), TileResult::kAccepted);
    mirror.apply_state(publisher.state());
    ASSERT_TRUE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), publisher.map());
    EXPECT_EQ(mirror.state()->version, static_cast<std::uint64_t>(i + 1));
  }
}

TEST(MapMirror, KeepsTheLastConsistentVersionUntilTheNextIsWhole) {
  std::mt19937 random(2);
  MapPublisher publisher(1);
  MapMirror mirror;
  for (const auto& tile : publisher.publish(test::random_votes(random)))
    mirror.apply_tile(1, tile.index, tile.version, tile.bytes);
  mirror.apply_state(publisher.state());
  const VoxelMap first = publisher.map();

  const auto tiles = publisher.publish(test::random_votes(random));
  mirror.apply_state(publisher.state());  // overtakes its tiles
  for (const auto& tile : tiles) {
    EXPECT_FALSE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), first);
    mirror.apply_tile(1, tile.index, tile.version, tile.bytes);
  }
  EXPECT_TRUE(mirror.is_consistent());
  EXPECT_EQ(*mirror.map(), publisher.map());
}

TEST(MapMirror, AnyOrderRepeatsAndLossEndInTheNewestVersion) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    MapPublisher publisher(1);
    MapMirror mirror;
    std::vector<MapPublisher::Tile> sent;
    std::vector<MapState> states;
    for (int i = 0; i < 6; ++i) {
      for (auto& tile : publisher.publish(test::random_votes(random))) sent.push_back(std::move(tile));
      states.push_back(publisher.state());
    }
    // Keep last 1 per key: older samples of a tile may be lost, the newest is not.
    std::erase_if(sent, [&](const MapPublisher::Tile& tile) {
      const bool is_newest = std::none_of(sent.begin(), sent.end(), [&](const MapPublisher::Tile& other) {
        return other.index == tile.index && other.version > tile.version;
      });
      return !is_newest && random() % 2 == 0;
    });
    std::shuffle(sent.begin(), sent.end(), random);
    std::shuffle(states.begin(), states.end(), random);
    for (std::size_t i = 0; i < sent.size(); ++i) {
      if (i < states.size()) mirror.apply_state(states[i]);
      mirror.apply_tile(1, sent[i].index, sent[i].version, sent[i].bytes);
      if (i % 3 == 0) mirror.apply_tile(1, sent[i].index, sent[i].version, sent[i].bytes);
    }
    for (const MapState& state : states) mirror.apply_state(state);
    ASSERT_TRUE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), publisher.map());
  }
}

TEST(MapMirror, ARestartedMapperReplacesTheMapAndOldSamplesAreDropped) {
  std::mt19937 random(3);
  MapPublisher before(10), after(11);
  MapMirror mirror;
  const auto old_tiles = before.publish(test::random_votes(random));
  for (const auto& tile : old_tiles) mirror.apply_tile(10, tile.index, tile.version, tile.bytes);
  mirror.apply_state(before.state());

  const auto new_tiles = after.publish(test::random_votes(random));
  for (const auto& tile : new_tiles) {
    mirror.apply_tile(11, tile.index, tile.version, tile.bytes);
    EXPECT_EQ(*mirror.map(), before.map());
  }
  EXPECT_EQ(mirror.apply_tile(10, old_tiles[0].index, 99, old_tiles[0].bytes), TileResult::kOutdated);
  mirror.apply_state(before.state());
  EXPECT_EQ(*mirror.map(), before.map());
  mirror.apply_state(after.state());
  EXPECT_TRUE(mirror.is_consistent());
  EXPECT_EQ(*mirror.map(), after.map());
}

// Two mappers one after the other, with voxels of two sizes; samples of both in any order, some twice, some never.
TEST(MapMirror, WhatIsServedIsAlwaysAVersionAsAWholeAlsoAcrossARestartWithGaps) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::map<std::pair<std::int64_t, std::uint64_t>, VoxelMap> published;
    std::vector<std::function<void(MapMirror&)>> samples;
    MapPublisher before(10, 0.1), after(11, 0.2);
    for (MapPublisher* publisher : {&before, &after}) {
      for (int i = 0; i < 5; ++i) {
        for (const auto& tile : publisher->publish(test::random_votes(random)))
          samples.emplace_back([tile, epoch = publisher->epoch()](MapMirror& mirror) {
            mirror.apply_tile(epoch, tile.index, tile.version, tile.bytes);
          });
        samples.emplace_back([state = publisher->state()](MapMirror& mirror) { mirror.apply_state(state); });
        published.insert({{publisher->epoch(), publisher->state().version}, publisher->map()});
      }
    }
    // In the end a late reader gets all; before, anything may happen.
    auto sent = samples;
    sent.insert(sent.end(), samples.begin(), samples.end());
    std::erase_if(sent, [&](const auto&) { return random() % 3 == 0; });
    std::shuffle(sent.begin(), sent.end(), random);
    sent.insert(sent.end(), samples.begin(), samples.end());

    MapMirror mirror;
    std::int64_t served_epoch = 0;
    for (const auto& apply : sent) {
      apply(mirror);
      if (mirror.map() == nullptr) continue;
      ASSERT_EQ(*mirror.map(), published.at({mirror.state()->epoch, mirror.state()->version}));
      ASSERT_GE(mirror.state()->epoch, served_epoch) << "a mapper that has ended does not come back";
      served_epoch = mirror.state()->epoch;
    }
    EXPECT_TRUE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), after.map());
  }
}

TEST(MapMirror, DamagedTilesAreReportedAndChangeNothing) {
  std::mt19937 random(3);
  MapPublisher publisher(1);
  MapMirror mirror;
  auto tiles = publisher.publish(test::random_votes(random));
  mirror.apply_state(publisher.state());
  const std::vector<std::uint8_t> damaged(tiles[0].bytes.begin(), tiles[0].bytes.end() - 1);
  EXPECT_EQ(mirror.apply_tile(1, tiles[0].index, 1, damaged), TileResult::kDamaged);
  for (const auto& tile : tiles) mirror.apply_tile(1, tile.index, tile.version, tile.bytes);
  EXPECT_EQ(*mirror.map(), publisher.map());
}

/// Blocks whose content differs, in the canonical order.
std::vector<BlockIndex> difference(const VoxelMap& before, const VoxelMap& after) {
  std::set<BlockIndex> blocks;
  for (const VoxelMap* map : {&before, &after}) {
    for (const BlockIndex& index : map->sorted_blocks()) blocks.insert(index);
  }
  std::erase_if(blocks, [&](const BlockIndex& index) {
    const VoxelBlock *a = before.find(index), *b = after.find(index);
    return a != nullptr && b != nullptr && *a == *b;
  });
  return {blocks.begin(), blocks.end()};
}

/// One hit in one block.
FrameVotes hit_in(const BlockIndex& block) {
  BlockVotes votes;
  votes.block = block;
  votes.hits_end = 1;
  return {{votes}, {{0, 1, kOneVote}}};
}

void apply_all(MapMirror& mirror, const MapPublisher& publisher, const std::vector<MapPublisher::Tile>& tiles) {
  for (const auto& tile : tiles) mirror.apply_tile(publisher.epoch(), tile.index, tile.version, tile.bytes);
  mirror.apply_state(publisher.state());
}

TEST(MapMirror, ChangedBlocksAreThoseOfAllVersionsSinceTheLastCall) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    MapPublisher publisher(1);
    MapMirror mirror;
    EXPECT_TRUE(mirror.take_changed_blocks().empty());
    VoxelMap known(kResolution_m);
    for (int i = 0; i < 8; ++i) {
      apply_all(mirror, publisher, publisher.publish(test::random_votes(random)));
      if (random() % 2 == 0) continue;  // several versions in one go
      EXPECT_EQ(mirror.take_changed_blocks(), difference(known, publisher.map()));
      EXPECT_TRUE(mirror.take_changed_blocks().empty());
      known = publisher.map();
    }
  }
}

TEST(MapMirror, BlocksOfATileThatHaveNotChangedAreNotAmongThem) {
  MapPublisher publisher(1);
  MapMirror mirror;
  apply_all(mirror, publisher, publisher.publish(hit_in({0, 0, 0})));
  mirror.take_changed_blocks();
  apply_all(mirror, publisher, publisher.publish(hit_in({1, 0, 0})));  // of the same tile
  EXPECT_EQ(mirror.take_changed_blocks(), (std::vector<BlockIndex>{{1, 0, 0}}));
}

TEST(MapMirror, BlocksThatAreGoneWithTheirMapperHaveChanged) {
  std::mt19937 random(7);
  MapPublisher before(10), after(11);
  MapMirror mirror;
  for (int i = 0; i < 3; ++i) apply_all(mirror, before, before.publish(test::random_votes(random)));
  mirror.take_changed_blocks();
  for (const auto& tile : after.publish(hit_in({9, 0, 0}))) mirror.apply_tile(11, tile.index, tile.version, tile.bytes);
  EXPECT_TRUE(mirror.take_changed_blocks().empty()) << "the old map is still served";
  mirror.apply_state(after.state());
  EXPECT_EQ(mirror.take_changed_blocks(), difference(before.map(), after.map()));
}

TEST(MapMirror, TwoRestartsBetweenCallsLeaveNoBlockBehind) {
  std::mt19937 random(8);
  MapPublisher first(1), second(2), third(3);
  MapMirror mirror;
  apply_all(mirror, first, first.publish(test::random_votes(random)));
  mirror.take_changed_blocks();
  apply_all(mirror, second, second.publish(hit_in({8, 0, 0})));
  apply_all(mirror, third, third.publish(hit_in({9, 0, 0})));
  EXPECT_THAT(mirror.take_changed_blocks(), ::testing::IsSupersetOf(difference(first.map(), third.map())));
}

TEST(MapMirror, DamagedTileChangesNoBlock) {
  std::mt19937 random(9);
  MapPublisher publisher(1);
  MapMirror mirror;
  apply_all(mirror, publisher, publisher.publish(test::random_votes(random)));
  mirror.take_changed_blocks();
  auto tiles = publisher.publish(test::random_votes(random));
  for (auto& tile : tiles) {
    std::vector<std::uint8_t> damaged(tile.bytes.begin(), tile.bytes.end() - 1);
    EXPECT_EQ(mirror.apply_tile(1, tile.index, tile.version, damaged), TileResult::kDamaged);
  }
  mirror.apply_state(publisher.state());
  EXPECT_TRUE(mirror.take_changed_blocks().empty());
  for (const auto& tile : tiles) mirror.apply_tile(1, tile.index, tile.version, tile.bytes);
  EXPECT_FALSE(mirror.take_changed_blocks().empty()) << "they may come again";
}

}  // namespace
}  // namespace lapis::mapping
