#include "simulator/core/truth/voxel_truth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "box_world.hpp"
#include "evaluator/core/map/coverage.hpp"
#include "evaluator/core/map/iou.hpp"
#include "evaluator/core/map/map_input.hpp"
#include "simulator/core/render/renderer.hpp"
#include "simulator/core/truth/explorable.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/truth/mesh_voxels.hpp"

namespace lapis::simulator {
namespace {

using ::testing::ElementsAre;

constexpr double kVoxel_m3 = 0.25 * 0.25 * 0.25;
constexpr geometry::PinholeCamera kTruthCamera{640, 360, 320.0, 320.0, 319.5, 179.5};

TruthConfig config() {
  TruthConfig out;
  out.camera = kTruthCamera;
  out.mount = {1.0, 0.0};
  out.view_spacing_m = 0.25;
  return out;
}

VoxelTruth truth_of(const Scene& scene, const geometry::Pose& T_world_base, const TruthConfig& config) {
  const SceneRaycaster raycaster(scene.mesh);
  return make_voxel_truth(scene, raycaster, build_nav_map(scene), T_world_base, config);
}

evaluator::KnownSpace known(const mapping::VoxelMap& map) {
  return evaluator::to_known_space(map, mapping::BeliefReader(mapping::SensorModel{}));
}

/// 6 x 5 x 2.5 m, class 1, with a pillar (2), a cabinet (3), and where they stand.
Scene furnished_room() {
  Scene scene = test::room({6, 5, 2.5F});
  test::add_box(scene, {2.75F, 2.25F, 0}, {3.25F, 2.75F, 2.5F}, 2);
  test::add_box(scene, {1, 1, 0}, {2, 2, 0.9F}, 3);
  return scene;
}

// The map's origin is chosen so that all surfaces run through the middle of voxels.
const geometry::Pose kStart = test::translation(4.125, 3.875, -0.125);

// A scan without a ceiling ends below the camera.
TEST(VoxelTruthTest, TheCameraMayBeAboveAllOfTheScene) {
  Scene scene = test::room({3, 3, 0.3F});
  std::erase_if(scene.mesh.triangles, [&](const Triangle& t) {  // the ceiling
    return std::all_of(t.vertices.begin(), t.vertices.end(),
                       [&](std::uint32_t v) { return scene.mesh.positions[v].z() > 0.2F; });
  });
  const VoxelTruth truth = truth_of(scene, test::translation(1.5, 1.5, 0.0), config());
  EXPECT_GT(evaluator::coverage(known(truth.mesh)).explored_volume_m3, 3 * 3 * 0.3);
  const SceneRaycaster raycaster(scene.mesh);
  const VoxelBox box = voxel_box(scene, geometry::Pose::Identity(), 0.25);
  EXPECT_THROW(visible_voxels(raycaster, {{1.5, 1.5, 4.0}}, {}, geometry::Pose::Identity(), box),
               std::invalid_argument);
}

TEST(VoxelTruthTest, OfARoomIsAllButTheInsideOfThings) {
  const VoxelTruth truth = truth_of(furnished_room(), kStart, config());
  // The room has 25 x 21 x 11 voxels; hidden are the pillar's core, floor to ceiling, and the cabinet's, floor to top.
  const double hidden = 1 * 1 * 11 + 3 * 3 * 4;
  const auto mesh = known(truth.mesh);
  EXPECT_DOUBLE_EQ(evaluator::coverage(mesh).explored_volume_m3, (25 * 21 * 11 - hidden) * kVoxel_m3);
  EXPECT_DOUBLE_EQ(evaluator::coverage(known(truth.flood)).explored_volume_m3, (25 * 21 * 11 - hidden) * kVoxel_m3);
  // Free are the inner voxels but those that pillar (3 x 3) and cabinet (5 x 5) fill.
  EXPECT_DOUBLE_EQ(evaluator::coverage(mesh).free_volume_m3, (23 * 19 * 9 - 9 * 9 - 25 * 4) * kVoxel_m3);
}

TEST(VoxelTruthTest, LabelsAreThoseOfTheSurface) {
  const auto mesh = known(truth_of(furnished_room(), kStart, config()).mesh);
  std::map<std::uint16_t, int> voxels;  // between floor and ceiling, where things share voxels with the room
  for (const auto& voxel : mesh.occupied.voxels) {
    if (voxel.index.z() > 0 && voxel.index.z() < 10) ++voxels[voxel.label];
  }
  EXPECT_EQ(voxels, (std::map<std::uint16_t, int>{{1, (25 * 21 - 23 * 19) * 9}, {2, 8 * 9}, {3, 3 * 16 + 25}}));
}

TEST(VoxelTruthTest, WhatTheCameraCannotLookUpToIsNotCounted) {
  const Scene scene = test::room({3, 3, 6});
  const auto truth = truth_of(scene, test::planar_pose(1.1, 1.2, 0.4), config());
  // From (0.2, 0.2) to the corner (3, 3), at the upper border of the image.
  const double highest_m = 1.0 + std::sqrt(2.0) * 2.8 * 179.5 / 320.0;
  double top_m = 0.0;
  truth.mesh.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts&) {
    top_m = std::max(top_m, 0.25 * (voxel.z + 1));
  });
  EXPECT_LE(top_m, highest_m + 0.25);
  EXPECT_GE(top_m, highest_m - 0.25);
  EXPECT_GT(evaluator::coverage(known(truth.flood)).explored_volume_m3, 3 * 3 * 6 * 0.9);
  TruthConfig tilted = config();
  tilted.mount.pitch_down_rad = -0.8;
  EXPECT_GT(known(truth_of(scene, test::planar_pose(1.1, 1.2, 0.4), tilted).mesh).occupied.voxels.size(),
            known(truth.mesh).occupied.voxels.size());
}

TEST(VoxelTruthTest, BeyondABarrierTheRangeIsTheEnd) {
  Scene scene = test::room({14, 2, 2.5F});
  test::add_box(scene, {3, 0, 0}, {3.05F, 2, 0.5F}, 2);
  const auto start = test::planar_pose(1, 1, 0);
  const auto truth = truth_of(scene, start, config());
  const auto furthest = [&](const mapping::VoxelMap& map) {
    double x_m = 0.0;
    map.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts&) {
      x_m = std::max(x_m, start.translation().x() + 0.25 * (voxel.x + 1));
    });
    return x_m;
  };
  EXPECT_NEAR(furthest(truth.mesh), 3.0 - 0.2 + 5.0, 0.3);
  EXPECT_NEAR(furthest(truth.flood), 14.0, 0.26);
}

// A gap through which the robot fits, but not with a margin: 0.44 m wide. A screen behind it hides most of the room.
TEST(VoxelTruthTest, WithAMarginNarrowGapsAreClosed) {
  Scene scene = test::room({6, 3, 2.5F});
  test::add_box(scene, {3, 0, 0}, {3.1F, 1.3F, 2.5F}, 2);
  test::add_box(scene, {3, 1.74F, 0}, {3.1F, 3, 2.5F}, 2);
  test::add_box(scene, {3.7F, 0.6F, 0}, {3.8F, 2.4F, 2.5F}, 2);
  const auto start = test::planar_pose(1, 1.5, 0);
  const auto volume = [&](const mapping::VoxelMap& map) { return evaluator::coverage(known(map)).explored_volume_m3; };
  TruthConfig cautious = config();
  cautious.margin_m = 0.1;
  const auto truth = truth_of(scene, start, cautious);
  EXPECT_LT(volume(truth.with_margin), 0.9 * volume(truth.mesh));
  EXPECT_GT(*evaluator::coverage(known(truth.with_margin), known(truth.mesh)).explored_share, 0.99);
  cautious.margin_m = 0.0;
  const auto bold = truth_of(scene, start, cautious);
  EXPECT_TRUE(bold.with_margin == bold.mesh);
  EXPECT_TRUE(bold.mesh == truth.mesh);
  cautious.margin_m = 1.0;
  EXPECT_EQ(truth_of(scene, test::planar_pose(2.5, 0.5, 0), cautious).with_margin.block_count(), 0U);
}

TEST(VoxelTruthTest, DoesNotDependOnTheNumberOfThreads) {
  TruthConfig two = config();
  two.threads = 2;
  const Scene scene = furnished_room();
  const auto start = test::planar_pose(4.2, 3.1, 2.2);
  const auto a = truth_of(scene, start, config()), b = truth_of(scene, start, two);
  EXPECT_TRUE(a.mesh == b.mesh);
  EXPECT_TRUE(a.flood == b.flood);
}

TEST(VoxelTruthTest, FrequentClassesAreByVoxelsThenById) {
  mapping::VoxelMap map(0.25);
  mapping::VoxelBlock block;
  int offset = 0;
  constexpr std::array<std::uint16_t, 12> kLabels = {5, 5, 5, 9, 9, 2, 2, 0, 0, 0, 0, 7};
  for (const std::uint16_t label : kLabels) block.add_hit(offset++, label, 256);
  block.add_miss(offset, 256);
  map.set_block({0, 0, 0}, block);
  EXPECT_THAT(most_frequent_classes(map), ElementsAre(5, 2, 9, 7));
  EXPECT_THAT(most_frequent_classes(map, 2), ElementsAre(5, 2));
}

// The camera's own rendering, the mapper's own integration: a second way to the same volume.
TEST(IdealMapTest, OfAWholeTourIsTheTruthOfTheMesh) {
  const Scene scene = furnished_room();
  const SceneRaycaster raycaster(scene.mesh);
  const Renderer renderer(scene, raycaster, {});
  const TruthConfig truth_config = config();
  const auto start = test::planar_pose(4.2, 3.1, 2.2);
  const auto truth = make_voxel_truth(scene, raycaster, build_nav_map(scene), start, truth_config);
  IdealMap ideal(mapping::kDefaultResolution_m, {});
  for (const auto& [x, y] :
       {std::pair(0.5, 0.5), {3.0, 0.6}, {5.5, 0.6}, {0.5, 4.5}, {3.0, 4.4}, {5.5, 4.5}, {4.2, 2.2}}) {
    for (int i = 0; i < 12; ++i) {
      const geometry::Pose T_world_camera =
          test::planar_pose(x, y, 0.1 + i * 2 * M_PI / 12) * geometry::T_base_camera(truth_config.mount);
      const auto frame = renderer.render(kTruthCamera, T_world_camera, false);
      ideal.add(kTruthCamera, T_map_world(start) * T_world_camera, frame.depth, frame.labels);
    }
  }
  const auto mesh = known(truth.mesh), seen = known(ideal.map());
  EXPECT_GT(evaluator::coverage(mesh, seen).explored_share.value(), 0.98);
  EXPECT_GT(evaluator::coverage(seen, mesh).explored_share.value(), 0.98);
  EXPECT_GT(evaluator::semantic_iou(mesh.occupied, seen.occupied).top_mean.value(), 0.8);
  EXPECT_THROW(ideal.add(kTruthCamera, start, geometry::DepthImage(3, 3), geometry::LabelImage(3, 3)),
               std::runtime_error);
}

}  // namespace
}  // namespace lapis::simulator
