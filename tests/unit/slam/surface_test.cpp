#include "slam/core/frame/surface.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "slam/core/frame/noise_model.hpp"
#include "slam/core/tracking/pose_refiner.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::DepthImage;
using geometry::Pose;

// A wall that is `distance_m` away along the optical axis.
struct Wall {
  double distance_m;
  Eigen::Vector3d normal;  // towards the camera
};

DepthImage look_at(const Wall& wall, unsigned seed, double moved_m = 0.0, double noise_share = 1.0) {
  const auto camera = test::small_camera();
  const NoiseConfig noise;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  DepthImage depth(camera.width, camera.height);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const double z = wall.normal.z() * (wall.distance_m - moved_m) / wall.normal.dot(camera.unproject(u, v, 1.0));
      depth(u, v) = static_cast<float>(z + noise_share * depth_sigma(noise, z) * normal(random));
    }
  }
  return depth;
}

std::vector<SurfaceSample> samples_of(const DepthImage& depth) {
  return sample_surface({}, {}, test::small_camera(), depth);
}

TEST(SampleSurface, KnowsTheNormalOfAWallBeyondTheNoise) {
  const Wall wall{6.0, Eigen::Vector3d(0.3, -0.2, -1.0).normalized()};
  const auto samples = samples_of(look_at(wall, 1));
  ASSERT_GT(samples.size(), 300U);
  double turned_rad2 = 0.0, away_m2 = 0.0;
  for (const SurfaceSample& sample : samples) {
    turned_rad2 += std::pow(std::acos(std::min(1.0, sample.normal.dot(wall.normal))), 2);
    away_m2 += std::pow(wall.normal.dot(sample.point) - wall.normal.z() * wall.distance_m, 2);
  }
  EXPECT_LT(std::sqrt(turned_rad2 / static_cast<double>(samples.size())), 0.2);
  EXPECT_LT(std::sqrt(away_m2 / static_cast<double>(samples.size())), 0.02);
}

DepthImage exact_look_at(const Wall& wall) { return look_at(wall, 0, 0.0, 0.0); }

TEST(SampleSurface, IsExactWithoutNoise) {
  const Wall wall{2.0, Eigen::Vector3d(-0.4, 0.1, -1.0).normalized()};
  const auto samples = samples_of(exact_look_at(wall));
  ASSERT_GT(samples.size(), 300U);
  for (const SurfaceSample& sample : samples) {
    EXPECT_NEAR(sample.normal.dot(wall.normal), 1.0, 1e-6);
    EXPECT_NEAR(sample.point.dot(wall.normal), wall.distance_m * wall.normal.z(), 1e-5);
  }
}

// At 3 m depth errs by 2.1 cm. The plane through a step of 10 cm in the middle of a cell leaves 2.5 cm (RMS), which is
// hard to tell from noise, but 4 cm in the lines beside it.
TEST(SampleSurface, LeavesOutSteps) {
  const Wall wall{3.0, {0.0, 0.0, -1.0}};
  const int size = SurfaceConfig{}.grid_step_px;
  DepthImage depth = look_at(wall, 4);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) depth(u, v) += u % size < size / 2 ? 0.1F : 0.0F;
  }
  EXPECT_GT(samples_of(look_at(wall, 4)).size(), 400U);
  EXPECT_LT(samples_of(depth).size(), 10U);
}

TEST(SampleSurface, LeavesOutHoles) {
  const auto camera = test::small_camera();
  DepthImage depth(camera.width, camera.height, 2.0F);
  EXPECT_GT(samples_of(depth).size(), 400U);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; u += 2) depth(u, v) = 0.0F;
  }
  EXPECT_TRUE(samples_of(depth).empty()) << "half of the pixels have no depth";
}

TEST(SampleSurface, LeavesOutWhatIsSeenEdgeOn) {
  const Wall floor{8.0, Eigen::Vector3d(0.0, -1.0, -0.05).normalized()};  // the camera is 0.4 m above it
  const auto samples = samples_of(exact_look_at(floor));
  ASSERT_GT(samples.size(), 50U);
  for (const SurfaceSample& sample : samples) {
    EXPECT_GT(-floor.normal.dot(sample.point.normalized()), 0.0999) << sample.point.transpose();
    EXPECT_LT(sample.point.z(), 4.1);
  }
}

// The depth of a wall at 6 m errs by 7 cm from pixel to pixel. A gate of less, around the pose that the alignment
// starts from, would find it confirmed.
TEST(SampleSurface, AFarWallMovesThePoseThatStartsBesideTheTruth) {
  const Wall wall{6.0, {0.0, 0.0, -1.0}};
  const double moved_m = 0.06;
  const SlamConfig config;
  const auto surface = samples_of(look_at(wall, 1));
  const DepthImage second = look_at(wall, 2, moved_m);
  const auto result = refine_pose(config, {test::small_camera(), {}, surface, &second}, Pose::Identity());
  EXPECT_NEAR(result.T_reference_camera.translation().z(), moved_m, 0.01);
  EXPECT_NEAR(std::sqrt(result.surface_variance), 1.0, 0.3) << "residuals are as large as the noise says";
}

}  // namespace
}  // namespace lapis::slam
