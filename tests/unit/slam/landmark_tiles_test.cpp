#include "slam/core/map/landmark_tiles.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace lapis::slam {
namespace {

using mapping::LandmarkTile;
using mapping::TileIndex;
using Tiles = std::map<TileIndex, LandmarkTile>;

constexpr int kKeyframes = 12;
constexpr int kFeatures = 400;
constexpr double kRounding_m = 1e-5;  // float32 at 30 m

/// A landmark as a consumer finds it.
struct Found {
  TileIndex tile;
  Eigen::Vector3d p_map;
  std::vector<KeyframeId> observers;
};

/// What a consumer has after an update.
void receive(const std::vector<LandmarkTile>& updates, Tiles& tiles) {
  for (const LandmarkTile& tile : updates) tiles.insert_or_assign(tile.index, tile);
}

std::map<LandmarkId, Found> landmarks_in(const Tiles& tiles) {
  std::map<LandmarkId, Found> found;
  for (const auto& [index, tile] : tiles) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < tile.ids.size(); ++i) {
      const std::size_t end = tile.observer_ends[i];
      Found landmark{index, tile.positions_m[i].cast<double>(), {}};
      for (std::size_t k = begin; k < end; ++k) landmark.observers.push_back(tile.observers[k]);
      EXPECT_TRUE(found.emplace(tile.ids[i], landmark).second) << "landmark " << tile.ids[i] << " is in two tiles";
      begin = end;
    }
    EXPECT_EQ(begin, tile.observers.size());
  }
  return found;
}

/// Everything that the tiles promise of the map, looked up landmark by landmark.
void expect_mirrors(const Map& map, std::size_t landmarks, const Tiles& tiles, const LandmarkTileConfig& config) {
  const auto found = landmarks_in(tiles);
  EXPECT_EQ(found.size(), map.landmark_count());
  for (LandmarkId id = 0; id < landmarks; ++id) {
    const Landmark& landmark = map.landmark(id);
    const auto it = found.find(id);
    ASSERT_EQ(it != found.end(), !landmark.observations.empty()) << id;
    if (it == found.end()) continue;
    const Found& mirrored = it->second;
    EXPECT_LE((mirrored.p_map - landmark.p_map).norm(), config.tolerance_m + kRounding_m);
    const std::int32_t cell[] = {mirrored.tile.x, mirrored.tile.y, mirrored.tile.z};
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(mirrored.p_map[axis], cell[axis] * config.edge_m - 1e-12);
      EXPECT_LT(mirrored.p_map[axis], (cell[axis] + 1) * config.edge_m);
    }
    std::vector<KeyframeId> observers;
    for (const Observation& observation : landmark.observations) observers.push_back(observation.keyframe);
    std::sort(observers.begin(), observers.end());
    EXPECT_EQ(mirrored.observers, observers) << id;
  }
}

std::uint64_t brute_force_checksum(const Tiles& tiles) {
  std::uint64_t sum = 0;
  for (const auto& [index, tile] : tiles) sum += mapping::tile_hash(index, tile.graph_version);
  return sum;
}

bool has_same_content(LandmarkTile a, const LandmarkTile& b) {
  a.graph_version = b.graph_version;
  return a == b;
}

/// A map that is edited at random.
class EditedMap {
 public:
  explicit EditedMap(unsigned seed) : random_(seed) {
    for (int i = 0; i < kKeyframes; ++i) add_keyframe();
  }

  void edit() {
    const int what = pick(100);
    if (count_ == 0 || what < 40) {
      const Eigen::Vector3d p = 8.0 * Eigen::Vector3d(unit_(random_), unit_(random_), 0.3 * unit_(random_));
      map.add_landmark(p, 1.0);
      observe(static_cast<LandmarkId>(count_++));
    } else if (what < 60) {
      observe(any_landmark());
    } else if (what < 75) {
      const LandmarkId id = any_landmark();
      const auto& observations = map.landmark(id).observations;
      if (!observations.empty())
        map.remove_observation(id, observations[static_cast<std::size_t>(pick(static_cast<int>(observations.size())))]);
    } else if (what < 98) {
      move(any_landmark(), pick(2) == 0 ? 0.003 : 0.3);
    } else {  // as a loop closure does
      for (LandmarkId id = 0; id < count_; ++id) move(id, 0.5);
    }
  }
  std::size_t landmarks() const { return count_; }
  int pick(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

  Map map;

 private:
  void add_keyframe() {
    Keyframe keyframe;
    keyframe.features = std::vector<Feature>(kFeatures);
    map.add_keyframe(keyframe);
  }
  void observe(LandmarkId id) { map.add_observation(id, {static_cast<KeyframeId>(pick(kKeyframes)), pick(kFeatures)}); }
  void move(LandmarkId id, double size_m) {
    const Eigen::Vector3d step(unit_(random_), unit_(random_), unit_(random_));
    map.set_position(id, map.landmark(id).p_map + size_m * step);
  }
  LandmarkId any_landmark() { return static_cast<LandmarkId>(pick(static_cast<int>(count_))); }

  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  std::size_t count_ = 0;
};

TEST(LandmarkTiles, MirrorTheMapThroughAThousandEdits) {
  for (const double tolerance_m : {0.0, 0.01}) {
    EditedMap edited(tolerance_m > 0.0 ? 1 : 2);
    LandmarkTileConfig config;
    config.tolerance_m = tolerance_m;
    LandmarkTiles incremental(config);
    Tiles tiles;
    std::uint64_t version = 0;
    for (int edit = 0; edit < 1000; ++edit) {
      edited.edit();
      if (edited.pick(3) > 0) continue;  // an update follows one edit or several
      const auto updates = incremental.update(edited.map, ++version);
      for (const LandmarkTile& tile : updates) {
        EXPECT_EQ(tile.graph_version, version);
        const auto before = tiles.find(tile.index);
        EXPECT_FALSE(before != tiles.end() && has_same_content(tile, before->second)) << "sent for nothing";
      }
      receive(updates, tiles);
      ASSERT_NO_FATAL_FAILURE(expect_mirrors(edited.map, edited.landmarks(), tiles, config));
      const auto state = incremental.state();
      EXPECT_EQ(state.graph_version, version);
      EXPECT_EQ(state.tiles, tiles.size());
      EXPECT_EQ(state.checksum, brute_force_checksum(tiles));
    }
    EXPECT_GT(edited.landmarks(), 300U);
    EXPECT_LT(edited.map.landmark_count(), edited.landmarks()) << "some have died";
  }
}

TEST(LandmarkTiles, WithoutToleranceTheyAreThoseMadeFromScratch) {
  EditedMap edited(3);
  LandmarkTileConfig exact;
  exact.tolerance_m = 0.0;
  LandmarkTiles incremental(exact);
  Tiles tiles;
  for (std::uint64_t version = 1; version <= 50; ++version) {
    for (int i = 0; i < 20; ++i) edited.edit();
    receive(incremental.update(edited.map, version), tiles);

    Tiles scratch;
    receive(LandmarkTiles(exact).update(edited.map, version), scratch);
    for (const auto& [index, tile] : tiles) {
      if (tile.ids.empty()) {
        EXPECT_FALSE(scratch.contains(index));
      } else {
        ASSERT_TRUE(scratch.contains(index));
        EXPECT_TRUE(has_same_content(tile, scratch.at(index)));
        scratch.erase(index);
      }
    }
    EXPECT_TRUE(scratch.empty());
  }
}

/// One landmark that two key-frames see.
class OneLandmark : public ::testing::Test {
 protected:
  OneLandmark() {
    Keyframe keyframe;
    keyframe.features = std::vector<Feature>(10);
    for (int i = 0; i < 3; ++i) map.add_keyframe(keyframe);
    id = map.add_landmark({1.0, 1.0, 1.0}, 1.0);
    map.add_observation(id, {1, 0});
    map.add_observation(id, {0, 0});
    EXPECT_EQ(update().size(), 1U);
  }
  std::vector<LandmarkTile> update() { return tiles.update(map, ++version); }
  void move_to(double x) { map.set_position(id, {x, 1.0, 1.0}); }

  Map map;
  LandmarkTiles tiles{LandmarkTileConfig{}};
  LandmarkId id = 0;
  std::uint64_t version = 0;
};

TEST_F(OneLandmark, IsSentAgainOnceItHasCreptBeyondTheTolerance) {
  const auto state = tiles.state();
  for (const double x : {1.004, 1.008, 0.995}) {
    move_to(x);
    EXPECT_TRUE(update().empty()) << x;
  }
  EXPECT_EQ(tiles.state().checksum, state.checksum);
  EXPECT_EQ(tiles.state().graph_version, version) << "a version without changes is one, too";
  move_to(1.012);
  const auto updates = update();
  ASSERT_EQ(updates.size(), 1U);
  EXPECT_FLOAT_EQ(updates[0].positions_m[0].x(), 1.012F);
}

TEST_F(OneLandmark, ChangesItsTileAtOnceAndTheOldOneIsEmpty) {
  move_to(-0.5);
  const auto updates = update();
  ASSERT_EQ(updates.size(), 2U);
  EXPECT_EQ(updates[0].index, (TileIndex{-1, 0, 0}));
  EXPECT_EQ(updates[0].ids, std::vector<std::uint32_t>{id});
  EXPECT_EQ(updates[1].index, (TileIndex{0, 0, 0}));
  EXPECT_TRUE(updates[1].ids.empty() && updates[1].observers.empty());
  EXPECT_EQ(tiles.state().tiles, 2U);
}

TEST_F(OneLandmark, IsSentAgainWithAnotherSetOfObserversOfTheSameNumber) {
  map.remove_observation(id, {0, 0});
  map.add_observation(id, {0, 5});
  EXPECT_TRUE(update().empty()) << "another feature of the same key-frame";
  map.remove_observation(id, {1, 0});
  map.add_observation(id, {2, 3});
  const auto updates = update();
  ASSERT_EQ(updates.size(), 1U);
  EXPECT_EQ(updates[0].observers, (std::vector<std::uint32_t>{0, 2}));
}

TEST_F(OneLandmark, IsInNoTileWhenDeadOrNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(1.0, nan, 1.0), Eigen::Vector3d(1.0, 1.0, 1e300)}) {
    map.set_position(id, p);
    const auto gone = update();
    ASSERT_EQ(gone.size(), 1U);
    EXPECT_TRUE(gone[0].ids.empty());
    move_to(1.0);
    ASSERT_EQ(update().size(), 1U);
  }
  map.remove_observation(id, {0, 0});
  map.remove_observation(id, {1, 0});
  const auto dead = update();
  ASSERT_EQ(dead.size(), 1U);
  EXPECT_TRUE(dead[0].ids.empty());
}

TEST(LandmarkTiles, AFullTileKeepsWhatMostKeyframesSee) {
  Map map;
  Keyframe keyframe;
  keyframe.features = std::vector<Feature>(100);
  for (int i = 0; i < 10; ++i) map.add_keyframe(keyframe);
  for (int k = 0; k < 100; ++k) {  // landmark k is seen by k / 10 + 1 key-frames
    const LandmarkId id = map.add_landmark({0.5, 0.5, 0.5}, 1.0);
    for (int i = 0; i <= k / 10; ++i) map.add_observation(id, {static_cast<KeyframeId>(i), k});
  }
  LandmarkTileConfig config;
  config.max_tile_bytes = 2000;
  const auto updates = LandmarkTiles(config).update(map, 1);
  ASSERT_EQ(updates.size(), 1U);
  const LandmarkTile& tile = updates[0];
  const std::size_t bytes = mapping::landmark_tile_bytes(tile.ids.size(), tile.observers.size());
  EXPECT_LE(bytes, config.max_tile_bytes);
  EXPECT_GT(bytes, config.max_tile_bytes - mapping::landmark_tile_bytes(1, 10));
  EXPECT_EQ(tile.ids.size() + tile.omitted, 100U);
  EXPECT_TRUE(std::is_sorted(tile.ids.begin(), tile.ids.end()));
  for (LandmarkId id = 90; id < 100; ++id) {
    EXPECT_TRUE(std::binary_search(tile.ids.begin(), tile.ids.end(), id)) << id;
  }
  EXPECT_FALSE(std::binary_search(tile.ids.begin(), tile.ids.end(), LandmarkId{0}));
}

}  // namespace
}  // namespace lapis::slam
