#include "common/mapping/wire/landmark_mirror.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace lapis::mapping {
namespace {

/// The publishing side, reduced to its promise: versions of tiles and a state after them.
class LandmarkPublisher {
 public:
  LandmarkPublisher(std::int64_t epoch, unsigned seed) : epoch_(epoch), random_(seed) {}

  std::vector<LandmarkTile> publish() {
    version_ += 1 + random_() % 3;
    std::vector<LandmarkTile> changed;
    for (std::int32_t x = 0; x < 5; ++x) {
      if (random_() % 2 == 0 && version_ > 3) continue;
      LandmarkTile tile;
      tile.index = {x, -x, 1};
      tile.graph_version = version_;
      for (std::uint32_t i = 0; i < random_() % 4; ++i) {  // may be empty
        tile.ids.push_back(i);
        tile.positions_m.emplace_back(Eigen::Vector3f::Random());
        tile.observers.push_back(static_cast<std::uint32_t>(random_() % 100));
        tile.observer_ends.push_back(i + 1);
      }
      tiles_.insert_or_assign(tile.index, tile);
      changed.push_back(tile);
    }
    return changed;
  }
  LandmarkState state() const {
    LandmarkState state{1, epoch_, version_, static_cast<std::uint32_t>(tiles_.size()), 0, 1.6, 0.01};
    for (const auto& [index, tile] : tiles_) state.checksum += tile_hash(index, tile.graph_version);
    return state;
  }
  const std::map<TileIndex, LandmarkTile>& tiles() const { return tiles_; }

 private:
  std::int64_t epoch_;
  std::mt19937 random_;
  std::uint64_t version_ = 0;
  std::map<TileIndex, LandmarkTile> tiles_;
};

TEST(LandmarkMirror, ServesEachVersionOnceItsTilesAreThereAndTheLastOneUntilThen) {
  LandmarkPublisher publisher(5, 1);
  LandmarkMirror mirror;
  EXPECT_FALSE(mirror.is_consistent() || mirror.state());
  for (int i = 0; i < 20; ++i) {
    const auto before = mirror.tiles();
    const auto tiles = publisher.publish();
    mirror.apply_state(publisher.state());  // overtakes its tiles
    for (const LandmarkTile& tile : tiles) {
      EXPECT_FALSE(mirror.is_consistent());
      EXPECT_EQ(mirror.tiles(), before);
      EXPECT_TRUE(mirror.apply_tile(5, tile));
      EXPECT_FALSE(mirror.apply_tile(5, tile)) << "known";
    }
    ASSERT_TRUE(mirror.is_consistent());
    EXPECT_EQ(mirror.state()->graph_version, publisher.state().graph_version);
    EXPECT_EQ(mirror.tiles(), publisher.tiles());
  }
}

TEST(LandmarkMirror, AnyOrderRepeatsAndLossEndInTheNewestVersion) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    LandmarkPublisher publisher(1, seed);
    LandmarkMirror mirror;
    std::vector<LandmarkTile> sent;
    std::vector<LandmarkState> states;
    for (int i = 0; i < 6; ++i) {
      for (auto& tile : publisher.publish()) sent.push_back(std::move(tile));
      states.push_back(publisher.state());
    }
    // Keep last 1 per key: older samples of a tile may be lost, the newest is not.
    std::erase_if(
        sent, [&](const LandmarkTile& tile) { return tile != publisher.tiles().at(tile.index) && random() % 2 == 0; });
    std::shuffle(sent.begin(), sent.end(), random);
    std::shuffle(states.begin(), states.end(), random);
    for (std::size_t i = 0; i < sent.size(); ++i) {
      if (i < states.size()) mirror.apply_state(states[i]);
      mirror.apply_tile(1, sent[i]);
      if (i % 3 == 0) mirror.apply_tile(1, sent[i]);
    }
    for (const LandmarkState& state : states) mirror.apply_state(state);
    ASSERT_TRUE(mirror.is_consistent()) << seed;
    EXPECT_EQ(mirror.tiles(), publisher.tiles());
  }
}

TEST(LandmarkMirror, ANewEpochReplacesEverythingAndOldSamplesAreDropped) {
  LandmarkPublisher before(10, 3), after(11, 4);
  LandmarkMirror mirror;
  const auto old_tiles = before.publish();
  for (const LandmarkTile& tile : old_tiles) mirror.apply_tile(10, tile);
  mirror.apply_state(before.state());
  ASSERT_TRUE(mirror.is_consistent());
  LandmarkTile leftover = old_tiles[0];

  const auto new_tiles = after.publish();
  for (const LandmarkTile& tile : new_tiles) {
    EXPECT_TRUE(mirror.apply_tile(11, tile));
    EXPECT_EQ(mirror.tiles(), before.tiles()) << "until the new ones are announced";
  }
  leftover.graph_version = 99;
  EXPECT_FALSE(mirror.apply_tile(10, leftover));
  mirror.apply_state(before.state());
  mirror.apply_state(after.state());
  ASSERT_TRUE(mirror.is_consistent());
  EXPECT_EQ(mirror.state()->epoch, 11);
  EXPECT_EQ(mirror.tiles(), after.tiles());
}

TEST(TileVersions, ChecksumDependsOnVersionsAndNotOnTheirOrder) {
  std::mt19937 random(7);
  std::vector<std::pair<TileIndex, std::uint64_t>> all;
  for (std::int32_t i = 0; i < 50; ++i) {
    for (std::uint64_t version = 1; version <= 3; ++version)
      all.push_back({{i % 7, i % 5 - 2, -i}, version + random() % 4});
  }
  std::map<TileIndex, std::uint64_t> newest;
  for (const auto& [index, version] : all) newest[index] = std::max(newest[index], version);
  std::uint64_t expected = 0;
  for (const auto& [index, version] : newest) expected += tile_hash(index, version);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(all.begin(), all.end(), random);
    TileVersions versions;
    for (const auto& [index, version] : all) versions.set(index, version);
    EXPECT_EQ(versions.checksum(), expected);
    EXPECT_EQ(versions.size(), newest.size());
    const auto& [index, version] = *newest.begin();
    EXPECT_FALSE(versions.set(index, version));
    EXPECT_TRUE(versions.set(index, version + 1));
    EXPECT_NE(versions.checksum(), expected);
  }
}

}  // namespace
}  // namespace lapis::mapping
