#include "simulator/core/full_map.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/mapping/model/sensor_model.hpp"
#include "simulator/core/truth/truth_files.hpp"
#include "simulator/core/truth/voxel_truth.hpp"
#include "tests/unit/simulator/truth/box_world.hpp"

namespace lapis::simulator {
namespace {

class FullMap : public ::testing::Test {
 protected:
  FullMap() {
    Scene scene = test::room({4, 3, 2.5F});
    test::add_box(scene, {2, 1, 0}, {2.5F, 1.5F, 0.8F}, 5);
    world = std::make_unique<World>(std::move(scene), WorldConfig{});
    config.camera = {160, 90, 80.0, 80.0, 79.5, 44.5};
    config.mount = {1.0, 0.0};
  }

  std::unique_ptr<World> world;
  const geometry::Pose start = test::planar_pose(0.7, 0.9, 0.6);
  FullMapConfig config;
};

// The mesh knows which surface the robot can see; the full map is what a mapper makes of it.
TEST_F(FullMap, HasTheSurfaceThatTheRobotCanSee) {
  TruthConfig truth;
  truth.camera = config.camera;
  truth.mount = config.mount;
  const VoxelTruth visible = make_voxel_truth(world->scene(), world->raycaster(), world->nav_map(), start, truth);
  const mapping::VoxelMap full = make_full_map(*world, start, config).map();
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  std::size_t surface = 0, found = 0, right = 0, stray = 0;
  visible.mesh.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    if (counts.hits.empty()) return;
    ++surface;
    const mapping::VoxelCounts there = full.read(voxel);
    if (!reader.is_occupied(there)) return;
    ++found;
    right += reader.label(there) == counts.hits.front().label ? 1 : 0;
  });
  full.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    if (reader.is_occupied(counts) && visible.mesh.read(voxel).hits.empty()) ++stray;
  });
  ASSERT_GT(surface, 500U);
  EXPECT_GT(static_cast<double>(found), 0.8 * static_cast<double>(surface));
  EXPECT_GT(static_cast<double>(right), 0.95 * static_cast<double>(found));
  EXPECT_LT(static_cast<double>(stray), 0.05 * static_cast<double>(surface));
  EXPECT_TRUE(full == make_full_map(*world, start, config).map());
}

TEST_F(FullMap, IsReadAgainOnlyForWhatItWasMadeOf) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "lapis_full_map_test.lapis";
  const std::string text = made_of(*world, start, config);
  EXPECT_FALSE(read_full_map(file, text)) << "no such file";
  write_full_map(file, world->scene(), make_full_map(*world, start, config), text);
  EXPECT_TRUE(read_full_map(file, text));
  EXPECT_FALSE(read_full_map(file, made_of(*world, test::planar_pose(0.7, 0.9, 0.61), config))) << "another map frame";
  FullMapConfig finer = config;
  finer.resolution_m = 0.1;
  EXPECT_FALSE(read_full_map(file, made_of(*world, start, finer)));
  finer = config;
  finer.frames.integration.max_range_m = 4.0;
  EXPECT_FALSE(read_full_map(file, made_of(*world, start, finer)));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_FALSE(read_full_map(file, text)) << "damaged";
  std::filesystem::remove(file);
}

TEST_F(FullMap, NeedsAPlaceToStand) {
  EXPECT_THROW(make_full_map(*world, test::planar_pose(-5, -5, 0), config), std::runtime_error);
}

}  // namespace
}  // namespace lapis::simulator
