#include "semantic_mapper/core/map_stakes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace lapis::semantic_mapper {
namespace {

constexpr double kVoxel_m = 0.25;

struct Sight {
  std::uint64_t keyframe;
  Eigen::Vector3d p_map_keyframe;
  mapping::FrameVotes votes;
};

/// Hits and misses in two blocks, some hits split between a class and "unlabelled".
Sight random_sight(std::mt19937& random) {
  std::uniform_int_distribution<std::uint64_t> keyframe(3, 9);
  std::uniform_real_distribution<double> metres(-3.0, 3.0);
  std::uniform_int_distribution<int> dice(0, 9);
  Sight sight{keyframe(random), {metres(random), metres(random), 1.0}, {}};
  for (const int x : {0, 1}) {
    mapping::BlockVotes block{{x, 0, 0}, {}, static_cast<std::uint32_t>(sight.votes.hits.size()), 0};
    for (unsigned offset = 0; offset < 40; ++offset) {
      const int number = dice(random);
      if (number < 3) {
        block.misses[0] |= std::uint64_t{1} << offset;
      } else if (number < 6) {
        const auto place = static_cast<std::uint16_t>(offset);
        const auto sure = static_cast<std::uint32_t>(20 * number);
        if (number == 5) sight.votes.hits.push_back({place, 0, 37});
        sight.votes.hits.push_back({place, 4, sure});
      }
    }
    block.hits_end = static_cast<std::uint32_t>(sight.votes.hits.size());
    sight.votes.blocks.push_back(block);
  }
  return sight;
}

/// The shares of every occupied voxel, one after the other [voxels].
std::map<std::uint64_t, std::map<int, double>> expected(const std::vector<Sight>& sights,
                                                        const mapping::VoxelMap& map) {
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  std::map<std::uint64_t, std::map<int, double>> stakes;
  map.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    if (!reader.is_occupied(counts)) return;
    std::map<std::pair<std::uint64_t, int>, double> weights;
    double whole = 0.0;
    for (const Sight& sight : sights) {
      const double range_m = (map.center_of(voxel) - sight.p_map_keyframe).norm();
      for (const auto& block : sight.votes.blocks) {
        for (const auto& hit : sight.votes.hits_of(block)) {
          if (mapping::voxel_at(block.block, hit.offset) != voxel) continue;
          weights[{sight.keyframe, static_cast<int>(range_m / kStakeBin_m)}] += hit.weight;
          whole += hit.weight;
        }
      }
    }
    for (const auto& [part, weight] : weights) stakes[part.first][part.second] += weight / whole;
  });
  return stakes;
}

void expect_equal(const MapStakes& stakes, const std::vector<Sight>& sights, const mapping::VoxelMap& map) {
  const auto wanted = expected(sights, map);
  EXPECT_EQ(stakes.stakes().size(), wanted.size());
  std::int64_t sum = 0;
  for (const auto& [keyframe, stake] : stakes.stakes()) {
    for (std::size_t bin = 0; bin < stake.size(); ++bin) {
      const auto known = wanted.at(keyframe).find(static_cast<int>(bin));
      const double voxels = known == wanted.at(keyframe).end() ? 0.0 : known->second;
      EXPECT_NEAR(static_cast<double>(stake[bin]) / static_cast<double>(kOneVoxel), voxels, 1e-5);
      sum += stake[bin];
    }
  }
  double all = 0.0;
  for (const auto& [keyframe, bins] : wanted) {
    for (const auto& [bin, voxels] : bins) all += voxels;
  }
  EXPECT_EQ(sum, kOneVoxel * std::llround(all));
}

// Frames come, go and move; in between the stakes are those of the map as it is.
TEST(MapStakes, SplitEveryOccupiedVoxelByItsVotes) {
  std::mt19937 random(3);
  mapping::VoxelMap map(kVoxel_m);
  MapStakes stakes(mapping::SensorModel{}, kVoxel_m);
  std::vector<Sight> sights;
  for (int step = 0; step < 120; ++step) {
    const bool goes = step % 3 == 2 || step > 80;
    if (goes && !sights.empty()) {
      std::swap(sights[std::uniform_int_distribution<std::size_t>(0, sights.size() - 1)(random)], sights.back());
      map.subtract(sights.back().votes);
      stakes.subtract(sights.back().keyframe, sights.back().p_map_keyframe, sights.back().votes);
      sights.pop_back();
    } else {
      sights.push_back(random_sight(random));
      map.add(sights.back().votes);
      stakes.add(sights.back().keyframe, sights.back().p_map_keyframe, sights.back().votes);
    }
    if (step % 4 != 0) continue;
    stakes.update(map);
    SCOPED_TRACE(step);
    expect_equal(stakes, sights, map);
  }
  EXPECT_TRUE(sights.empty());
  stakes.update(map);
  EXPECT_TRUE(stakes.stakes().empty());
}

// The same votes in another order give the same bits.
TEST(MapStakes, DoNotDependOnTheOrder) {
  std::mt19937 random(4);
  std::vector<Sight> sights;
  for (int i = 0; i < 30; ++i) sights.push_back(random_sight(random));
  mapping::VoxelMap map(kVoxel_m);
  for (const Sight& sight : sights) map.add(sight.votes);
  MapStakes forwards(mapping::SensorModel{}, kVoxel_m), backwards(mapping::SensorModel{}, kVoxel_m);
  for (const Sight& sight : sights) {
    forwards.add(sight.keyframe, sight.p_map_keyframe, sight.votes);
    forwards.update(map);
  }
  std::for_each(sights.rbegin(), sights.rend(),
                [&](const Sight& sight) { backwards.add(sight.keyframe, sight.p_map_keyframe, sight.votes); });
  backwards.update(map);
  EXPECT_EQ(forwards.stakes(), backwards.stakes());
}

TEST(MapStakes, RefuseVotesThatNeverCame) {
  std::mt19937 random(5);
  const Sight sight = random_sight(random);
  MapStakes stakes(mapping::SensorModel{}, kVoxel_m);
  stakes.add(sight.keyframe, sight.p_map_keyframe, sight.votes);
  EXPECT_THROW(stakes.subtract(sight.keyframe + 1, sight.p_map_keyframe, sight.votes), std::logic_error);
}

}  // namespace
}  // namespace lapis::semantic_mapper
