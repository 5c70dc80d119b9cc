#include "slam/core/frame/frame.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "slam/core/frame/surface.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

// Depth image of the plane n'p = d, and the depth of a pixel on it.
double plane_depth(const geometry::PinholeCamera& camera, const Eigen::Vector3d& normal, double d,
                   const Eigen::Vector2d& pixel) {
  return d / normal.dot(camera.unproject(pixel.x(), pixel.y(), 1.0));
}

geometry::DepthImage plane_image(const geometry::PinholeCamera& camera, const Eigen::Vector3d& normal, double d) {
  geometry::DepthImage depth(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) depth(x, y) = static_cast<float>(plane_depth(camera, normal, d, {x, y}));
  }
  return depth;
}

TEST(InterpolateDepth, IsExactOnAPlane) {
  const auto camera = test::small_camera();
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, 1.0).normalized();
  const auto depth = plane_image(camera, normal, 2.0);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(10.25, 20.5), {160.0, 120.0}, {300.9, 200.1}}) {
    EXPECT_NEAR(interpolate_depth({}, depth, pixel), plane_depth(camera, normal, 2.0, pixel), 1e-6);
  }
}

TEST(InterpolateDepth, GivesNoneAtEdgesHolesAndBorders) {
  geometry::DepthImage depth(20, 20, 2.0F);
  for (int y = 0; y < 20; ++y) depth(10, y) = 3.0F;  // another surface
  depth(5, 5) = 0.0F;
  EXPECT_NEAR(interpolate_depth({}, depth, {2.5, 2.5}), 2.0, 1e-9);
  EXPECT_EQ(interpolate_depth({}, depth, {9.5, 3.0}), 0.0);
  EXPECT_EQ(interpolate_depth({}, depth, {4.7, 4.7}), 0.0);
  EXPECT_EQ(interpolate_depth({}, depth, {-0.1, 3.0}), 0.0);
  EXPECT_EQ(interpolate_depth({}, depth, {19.0, 3.0}), 0.0);
}

TEST(FeatureIndex, FindsWhatBruteForceFinds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(0.0, 319.0), y(0.0, 239.0), radius(0.5, 60.0);
  std::vector<Feature> features(300);
  for (Feature& feature : features) feature.pixel = {x(random), y(random)};
  const FeatureIndex index(features, 320, 240);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d pixel(x(random), y(random));
    const double r = radius(random);
    std::vector<int> expected, found;
    for (int i = 0; i < 300; ++i) {
      if ((features[static_cast<std::size_t>(i)].pixel - pixel).cwiseAbs().maxCoeff() <= r) expected.push_back(i);
    }
    index.find(pixel, r, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace lapis::slam
