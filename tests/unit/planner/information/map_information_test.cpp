#include "planner/core/information/map_information.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/unit/planner/information/random_map.hpp"

namespace lapis::planner {
namespace {

constexpr double kEdge_m = 0.25;

mapping::SensorModel twelve_classes(const std::string& fusion) {
  mapping::SensorModel model;
  model.fusion = fusion;
  model.class_count = 12;
  return model;
}

/// Voxel by voxel, from the probabilities.
double plain_nats(const mapping::VoxelMap& map, const mapping::SensorModel& model) {
  const mapping::BeliefReader reader(model);
  double nats = 0.0;
  map.for_each_observed([&](const mapping::VoxelIndex&, const mapping::VoxelCounts& counts) {
    nats += reader.entropy({}) - reader.entropy(counts);
  });
  return nats;
}

TEST(MapInformation, IsWhatTheEntropyOfAllVoxelsHasFallen) {
  std::mt19937 random(7);
  for (const char* fusion : {"log_odds", "dirichlet"}) {
    const auto model = twelve_classes(fusion);
    const auto map = test::random_map(random, kEdge_m, model.class_count);
    MapInformation information(model);
    information.update(map, map.sorted_blocks());
    EXPECT_NEAR(information.nats(), plain_nats(map, model), 1e-9 * std::abs(plain_nats(map, model))) << fusion;
  }
}

TEST(MapInformation, FollowsChangesAndBlocksThatAreGone) {
  std::mt19937 random(8);
  const auto model = twelve_classes("log_odds");
  const auto before = test::random_map(random, kEdge_m, model.class_count),
             later = test::random_map(random, kEdge_m, model.class_count);
  MapInformation information(model);
  information.update(before, before.sorted_blocks());
  auto changed = before.sorted_blocks();
  for (const auto& block : later.sorted_blocks()) changed.push_back(block);
  information.update(later, changed);
  EXPECT_NEAR(information.nats(), plain_nats(later, model), 1e-9 * std::abs(plain_nats(later, model)));
  information.update(mapping::VoxelMap(kEdge_m), changed);
  EXPECT_NEAR(information.nats(), 0.0, 1e-9);
}

}  // namespace
}  // namespace lapis::planner
