#include "semantic_mapper/core/obstacle_layer.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "common/mapping/votes/integration.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;
using lapis::test::Box;

constexpr double kResolution_m = 0.1;
constexpr double kRate_hz = 15.0;
const geometry::PinholeCamera kLayerCamera{160, 90, 80, 80, 79.5, 44.5};

/// A room with a box of 0.4 m that somebody moves, and a camera that looks along x.
class Scene {
 public:
  explicit Scene(const ObstacleConfig& config = {}) : layer(config, mapping::HeightBand{}, kResolution_m) {}

  static Box box_at(double y) { return {{1.8, y - 0.2, 0.0}, {2.2, y + 0.2, 0.8}, 9}; }
  void look(const std::vector<Box>& boxes, double yaw_rad = 0.0) {
    const Pose T = lapis::test::look({0.03, 0.02, 1.0}, yaw_rad, 0.15);
    const auto image = lapis::test::render(boxes, kLayerCamera, T);
    std::string error;
    const auto frame = mapping::CompactFrame::make(kLayerCamera, image.depth, &image.labels, {1, 40}, error).value();
    layer.add(now, mapping::compute_votes(frame, T, {}, kResolution_m));
    now = now + time::Duration::from_seconds(1.0 / kRate_hz);
  }
  void look_for(double seconds, const std::vector<Box>& boxes, double yaw_rad = 0.0) {
    for (int i = 0; i < std::lround(seconds * kRate_hz); ++i) look(boxes, yaw_rad);
  }
  std::int8_t cell(double x, double y) const {
    const OccupancyGrid grid = layer.grid();
    const auto column = static_cast<int>(std::floor((x - grid.origin_x_m) / grid.resolution_m));
    const auto row = static_cast<int>(std::floor((y - grid.origin_y_m) / grid.resolution_m));
    if (column < 0 || row < 0 || column >= grid.width || row >= grid.height) return kUnknown;
    return grid
        .cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(column)];
  }

  ObstacleLayer layer;
  time::Time now{1'000'000'000};
};

std::vector<Box> room_with(const std::vector<Box>& more) {
  std::vector<Box> boxes{{{3.0, -4.0, 0.0}, {3.3, 4.0, 2.6}, 1}, {{-4.0, -4.0, -0.3}, {4.0, 4.0, 0.0}, 2}};
  boxes.insert(boxes.end(), more.begin(), more.end());
  return boxes;
}

constexpr double kFront_x = 1.85;  // the first layer of voxels of the box

TEST(ObstacleLayer, FollowsAMovedObstacleBothWaysHoweverLongItStood) {
  Scene scene;
  scene.look_for(60.0, room_with({Scene::box_at(-0.8)}));
  EXPECT_EQ(scene.cell(kFront_x, -0.75), kOccupied);
  EXPECT_EQ(scene.cell(kFront_x, 0.85), kFree);
  scene.look(room_with({Scene::box_at(0.8)}));
  EXPECT_EQ(scene.cell(kFront_x, 0.85), kOccupied) << "appears with the first frame that sees it";
  scene.look(room_with({Scene::box_at(0.8)}));
  scene.look(room_with({Scene::box_at(0.8)}));
  EXPECT_EQ(scene.cell(kFront_x, -0.75), kFree) << "three frames have looked through its old place";
  EXPECT_EQ(scene.cell(3.05, 0.0), kOccupied) << "the wall stays";
}

TEST(ObstacleLayer, WhatIsNotLookedAtStaysForTheWindowAndIsThenForgotten) {
  Scene scene({.window_s = 10.0, .misses_to_clear = 3});
  scene.look_for(1.0, room_with({Scene::box_at(0.0)}));
  scene.look_for(9.8, room_with({}), M_PI);  // away: nobody knows that it is gone
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kOccupied);
  scene.look_for(1.0, room_with({}), M_PI);
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kUnknown);
  scene.look(room_with({}));
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kFree) << "what was forgotten does not come back";
}

TEST(ObstacleLayer, LookingOverALowObstacleDoesNotClearIt) {
  Scene scene;
  const Box low{{1.8, -0.2, 0.0}, {2.2, 0.2, 0.35}, 9};
  scene.look_for(1.0, room_with({low}));
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kOccupied);
  for (int i = 0; i < 15; ++i) {  // the camera has gone near: its rays go over the obstacle, as votes above it say
    mapping::FrameVotes votes;
    const mapping::VoxelIndex above{18, 0, 8};
    votes.blocks.push_back({mapping::block_of(above), {}, 0, 0});
    const int offset = mapping::offset_in_block(above);
    votes.blocks[0].misses[static_cast<std::size_t>(offset) / 64] |= std::uint64_t{1} << (offset % 64);
    scene.layer.add(scene.now, votes);
  }
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kOccupied);
}

TEST(ObstacleLayer, OnlyTheBandCounts) {
  Scene scene;
  scene.look_for(1.0, room_with({{{1.8, -0.2, 1.3}, {2.2, 0.2, 1.6}, 9}}));  // a lamp above the robot
  EXPECT_EQ(scene.cell(kFront_x, 0.05), kFree);
  EXPECT_EQ(scene.cell(1.5, 0.05), kFree) << "the floor is no obstacle";
}

TEST(ObstacleLayer, MemoryIsBoundedByTheWindow) {
  Scene scene({.window_s = 1.0, .misses_to_clear = 3});
  scene.look_for(2.0, room_with({}));
  const std::size_t bytes = scene.layer.bytes();
  for (int turn = 0; turn < 8; ++turn) scene.look_for(2.0, room_with({}), turn * M_PI / 4);
  scene.look_for(2.0, room_with({}));
  EXPECT_EQ(scene.layer.bytes(), bytes);
}

TEST(ObstacleLayer, RefusesValuesOutOfRange) {
  EXPECT_THROW(ObstacleLayer({0.0, 3}, {}, kResolution_m), std::runtime_error);
  EXPECT_THROW(ObstacleLayer({10.0, 0}, {}, kResolution_m), std::runtime_error);
}

}  // namespace
}  // namespace lapis::semantic_mapper
