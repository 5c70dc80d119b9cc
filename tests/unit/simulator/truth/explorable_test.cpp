#include "simulator/core/truth/explorable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "box_world.hpp"
#include "simulator/core/truth/mesh_voxels.hpp"

namespace lapis::simulator {
namespace {

constexpr geometry::PinholeCamera kCamera{640, 360, 320.0, 320.0, 319.5, 179.5};

/// Where the segment meets a triangle, as a share of its length [Moeller, Trumbore, 1997].
std::optional<double> meets(const Mesh& mesh, const Triangle& triangle, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& along) {
  const auto p = [&](std::size_t i) -> Eigen::Vector3d { return mesh.positions[triangle.vertices[i]].cast<double>(); };
  const Eigen::Vector3d a = p(1) - p(0), b = p(2) - p(0), n = along.cross(b);
  const double determinant = a.dot(n);
  if (std::abs(determinant) < 1e-12) return std::nullopt;
  const Eigen::Vector3d s = origin - p(0);
  const double u = s.dot(n) / determinant;
  const Eigen::Vector3d q = s.cross(a);
  const double v = along.dot(q) / determinant, t = b.dot(q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || t < 0.0 || t > 1.0) return std::nullopt;
  return t;
}

bool is_visible(const Mesh& mesh, const std::vector<Eigen::Vector3d>& eyes, const VisibilityConfig& config,
                const Eigen::Vector3d& p) {
  for (const auto& eye : eyes) {
    const Eigen::Vector3d along = p - eye;
    const double up = std::asin(along.normalized().z());
    if (along.norm() > config.range_m || up < config.elevation.low_rad || up > config.elevation.high_rad) continue;
    bool is_free = true;
    for (const auto& triangle : mesh.triangles) is_free = is_free && !meets(mesh, triangle, eye, along);
    if (is_free) return true;
  }
  return false;
}

TEST(VisibleVoxels, AreThoseOfWhichAPointCanBeSeen) {
  Scene scene = test::room({3, 2.4F, 2.2F});
  test::add_box(scene, {1.2F, 0.8F, 0}, {1.5F, 1.1F, 2.2F}, 2);      // pillar
  test::add_box(scene, {2.2F, 1.6F, 0.7F}, {2.9F, 2.3F, 0.75F}, 3);  // shelf
  const SceneRaycaster raycaster(scene.mesh);
  const std::vector<Eigen::Vector3d> eyes = {{0.4, 0.4, 1.0}, {0.5, 1.9, 1.0}, {1.4, 0.3, 1.0}};
  const VisibilityConfig config{{-0.5, 0.4}, 2.0, 1};
  const geometry::Pose T = test::planar_pose(-0.4, -0.4, 0.3);
  const VoxelBox box = voxel_box(scene, T, 0.25);
  const VoxelSet seen = visible_voxels(raycaster, eyes, config, T, box);
  VoxelSet solid(box);
  for (const auto& voxel : surface_voxels(scene, T, box)) solid.insert(voxel.cell);
  int wrong = 0, compared = 0, visible = 0;
  for (std::size_t cell = 0; cell < box.size(); ++cell) {
    if (solid.contains(cell)) continue;  // surface is met, not passed
    const mapping::VoxelIndex index = box.index_of(cell);
    bool expected = false;
    for (int i = 0; i < 6 * 6 * 6 && !expected; ++i) {
      const Eigen::Vector3i part(i % 6, i / 6 % 6, i / 36);
      const Eigen::Vector3d p =
          Eigen::Vector3d(index.x, index.y, index.z) + (part.cast<double>().array() + 0.5).matrix() / 6.0;
      expected = is_visible(scene.mesh, eyes, config, T.inverse() * (p * 0.25));
    }
    ++compared;
    visible += expected ? 1 : 0;
    wrong += expected != seen.contains(cell) ? 1 : 0;
  }
  EXPECT_GT(visible, 200);
  EXPECT_GT(compared - visible, 200);
  EXPECT_LE(wrong, compared / 50) << "of " << compared;  // corners of voxels that lie between rays or points
}

TEST(VisibleVoxels, DoNotDependOnTheNumberOfThreads) {
  Scene scene = test::room({6, 4, 2.5F});
  test::add_box(scene, {2, 1, 0}, {3, 3, 1.6F}, 2);
  const SceneRaycaster raycaster(scene.mesh);
  std::vector<Eigen::Vector3d> eyes;
  for (int i = 0; i < 7; ++i) eyes.emplace_back(0.5 + 0.1 * i, 0.5 + 0.4 * i, 1.0);
  const geometry::Pose T = test::planar_pose(1, 2, 0.5);
  const VoxelBox box = voxel_box(scene, T, 0.1);
  const VisibilityConfig config{{-0.5, 0.5}, 5.0, 1};
  const VoxelSet one = visible_voxels(raycaster, eyes, config, T, box);
  for (const int threads : {2, 3, 16}) {
    EXPECT_EQ(one, visible_voxels(raycaster, eyes, {config.elevation, config.range_m, threads}, T, box)) << threads;
  }
}

TEST(VisibleVoxels, ARayThatMeetsNothingSaysNothing) {
  Scene scene;
  test::add_box(scene, {2, -1, 0}, {3, 1, 2}, 1);
  const SceneRaycaster raycaster(scene.mesh);
  const VoxelBox box(Eigen::AlignedBox3d(Eigen::Vector3d(-8, -8, -8), Eigen::Vector3d(8, 8, 8)), 0.25);
  const geometry::Pose I = geometry::Pose::Identity();
  const std::vector<Eigen::Vector3d> eyes = {{0.1, 0.1, 1.0}};
  for (const std::size_t cell : visible_voxels(raycaster, eyes, {{-0.5, 0.5}, 5.0, 1}, I, box).cells()) {
    const auto index = box.index_of(cell);
    EXPECT_TRUE(index.x >= 0 && index.x <= 8) << index.x;
  }
}

TEST(ElevationRangeTest, HoldsTheElevationsOfAllPixels) {
  for (const double pitch : {-1.5, -0.3, 0.0, 0.2, 0.9, 1.2, 1.57}) {
    const ElevationRange range = elevation_range(kCamera, pitch);
    const Eigen::Matrix3d R = geometry::T_base_camera({1.0, pitch}).linear();
    double low = 10.0, high = -10.0;
    for (int row = 0; row < kCamera.height; ++row) {
      for (int column = 0; column < kCamera.width; ++column) {
        const double up = std::asin((R * kCamera.unproject(column, row, 1.0)).normalized().z());
        low = std::min(low, up);
        high = std::max(high, up);
      }
    }
    EXPECT_NEAR(range.low_rad, low, 0.003) << pitch;
    EXPECT_NEAR(range.high_rad, high, 0.003) << pitch;
  }
  EXPECT_NEAR(elevation_range(kCamera, 0.0).high_rad, std::atan(179.5 / 320.0), 1e-5);
}

TEST(Viewpoints, StandForAllReachableCells) {
  Scene scene = test::room({5, 4, 2.5F});
  test::add_box(scene, {3, 0, 0}, {3.1F, 4, 2.5F}, 2);  // a wall without a door
  const NavMap map = build_nav_map(scene);
  const Eigen::Vector2d start(1, 1);
  const auto reachable = map.reachable(start, 0.2);
  const auto points = viewpoints(map, start, 0.2, 0.5);
  for (const auto& p : points) {
    EXPECT_LT(p.x(), 2.85);
    EXPECT_GE(map.distance_m(p), 0.18);
  }
  for (int row = 0; row < reachable.height; ++row) {
    for (int column = 0; column < reachable.width; ++column) {
      if (reachable(column, row) == 0) continue;
      double nearest = 1e9;
      for (const auto& p : points) nearest = std::min(nearest, (p - map.grid().center({column, row})).norm());
      ASSERT_LT(nearest, 0.5 * std::numbers::sqrt2);
    }
  }
  EXPECT_LT(points.size(), 60U);
  EXPECT_TRUE(viewpoints(map, {3.05, 1}, 0.2, 0.5).empty()) << "it does not fit there";
}

TEST(FloodedVoxels, FillARoomAndTakeItsWalls) {
  Scene scene = test::room({4, 3, 2.5F});
  test::add_box(scene, {1, 1, 0.5F}, {2, 2, 1.5F}, 2);  // 3 x 3 x 3 voxels inside
  const geometry::Pose T = test::translation(0.125, 0.125, 0.125);
  const VoxelBox box = voxel_box(scene, T, 0.25);
  VoxelSet solid(box);
  for (const auto& voxel : surface_voxels(scene, T, box)) solid.insert(voxel.cell);
  EXPECT_EQ(flooded_voxels(solid, {{0.5, 0.5, 1.0}}, T, box).count(), 17U * 13 * 11 - 27U);
  EXPECT_EQ(flooded_voxels(solid, {{1.5, 1.5, 1.0}}, T, box).count(), 5U * 5 * 5);
  EXPECT_EQ(flooded_voxels(solid, {{0.0, 0.5, 1.0}, {100, 0, 0}}, T, box).count(), 0U);  // in a wall; far away
}

}  // namespace
}  // namespace lapis::simulator
