#include "planner/core/hallucination/landmark_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

using test::camera_at;
using test::Chain;
using test::free_field;
using test::kCamera;
using test::tile_of;
using test::wall_at;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Key-frame 10 (node 0) looks along x at a wall that is 3 m away; key-frame 11 has not seen it.
struct OneWall {
  AnalysedGraph graph = Chain({camera_at(0, 0, 0), camera_at(0, 1, 0)}).graph();
  LandmarkIndex index{tile_of(wall_at(3.0f), {10}), graph, 0.25};
  CovisibilityConfig config;

  std::vector<Covisibility> seen_from(const geometry::Pose& pose, const InformationField& field = free_field()) const {
    return index.predict(kCamera, pose, field, config);
  }
};

TEST(LandmarkIndex, SeesAgainWhatAKeyframeSaw) {
  const OneWall world;
  EXPECT_EQ(world.index.size(), 100u);
  EXPECT_THAT(world.seen_from(camera_at(0.2, 0.1, 0.1)), ElementsAre(Covisibility{0, 100}));
}

TEST(LandmarkIndex, CountsWhatKeyframesShare) {
  const AnalysedGraph graph = Chain({camera_at(0, 0, 0), camera_at(0, 1, 0)}).graph();
  EXPECT_EQ(OneWall().index.shared_landmarks(0), 0) << "nobody else has seen it";
  const LandmarkIndex both(tile_of(wall_at(3.0f), {10, 11}), graph, 0.25);
  EXPECT_EQ(both.shared_landmarks(0), 100);
  EXPECT_EQ(both.shared_landmarks(1), 100);
}

TEST(LandmarkIndex, NotBehindTheCameraOrBeyondTheImageOrRange) {
  OneWall world;
  EXPECT_THAT(world.seen_from(camera_at(0, 0, 3.0)), IsEmpty());
  EXPECT_THAT(world.seen_from(camera_at(0, 0, 1.2)), IsEmpty());
  world.config.max_range_m = 2.5;
  EXPECT_THAT(world.seen_from(camera_at(0, 0, 0)), IsEmpty());
}

TEST(LandmarkIndex, HalfTheWallIsOnTheImage) {
  const auto seen = OneWall().seen_from(camera_at(0, 0, std::atan(1.0)));  // the image ends at the heading of x
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].landmarks, 50);
}

TEST(LandmarkIndex, OnlyFromASimilarDirectionAndDistance) {
  OneWall world;
  EXPECT_THAT(world.seen_from(camera_at(3.0, -2.5, 1.57)), IsEmpty()) << "from the side";
  world.config.max_viewing_angle_rad = 3.2;
  EXPECT_FALSE(world.seen_from(camera_at(3.0, -2.5, 1.57)).empty());
  EXPECT_THAT(world.seen_from(camera_at(1.9, 0, 0)), IsEmpty()) << "from a third of the distance";
  world.config.max_range_ratio = 5.0;
  EXPECT_FALSE(world.seen_from(camera_at(1.9, 0, 0)).empty());
}

TEST(LandmarkIndex, NotThroughWalls) {
  OneWall world;
  world.config.max_range_m = 6.0;
  const geometry::Pose behind = camera_at(-2.1, 0, 0);  // the block between -2 and 0 stands in the way
  EXPECT_THAT(world.seen_from(behind), ElementsAre(Covisibility{0, 100}));
  EXPECT_THAT(world.seen_from(behind, free_field({{-1, -1, 0}, {-1, 0, 0}})), IsEmpty());
}

TEST(LandmarkIndex, PredictsOnlyForTheKeyframesThatAreWanted) {
  const OneWall world;
  const LandmarkIndex both(tile_of(wall_at(3.0f), {10, 11}), world.graph, 0.25);
  const geometry::Pose pose = camera_at(0.2, 0.1, 0.1);
  const auto seen = [&](const std::vector<bool>& wanted, int least) {
    return both.predict(kCamera, pose, free_field(), world.config, wanted, least);
  };
  EXPECT_EQ(seen({true, true}, 1), both.predict(kCamera, pose, free_field(), world.config));
  EXPECT_THAT(seen({false, true}, 100), ElementsAre(Covisibility{1, 100}));
  EXPECT_THAT(seen({true, true}, 101), IsEmpty());
}

TEST(LandmarkIndex, LeavesOutLandmarksOfForgottenKeyframes) {
  const OneWall world;
  EXPECT_EQ(LandmarkIndex(tile_of(wall_at(3.0f), {99}), world.graph, 0.25).size(), 0u);
}

TEST(FreeProbability, IsTheProductUpToTheSurface) {
  InformationField field = free_field();
  const Eigen::Vector3d from(0.1, 0.1, 1.1), to(1.9, 0.1, 1.1);
  EXPECT_EQ(free_probability(field, from, to), 1.0);
  std::vector<CellInformation> cells(mapping::kBlockVoxels, {0.5, 0.0});
  field.set_block({0, 0, 0}, std::span<const CellInformation, 512>(cells));
  // Voxels 0 to 7 along x: not the camera's, not the surface's (7), not the one before it (6).
  EXPECT_DOUBLE_EQ(free_probability(field, from, to), std::pow(0.5, 5));
}

}  // namespace
}  // namespace lapis::planner
