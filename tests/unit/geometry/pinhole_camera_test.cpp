#include "common/geometry/pinhole_camera.hpp"

#include <gtest/gtest.h>

namespace lapis::geometry {
namespace {

constexpr PinholeCamera kCamera{640, 360, 320.0, 310.0, 319.5, 179.5};

TEST(PinholeCamera, ProjectInvertsUnproject) {
  for (double u = 0.0; u < 640.0; u += 71.3) {
    for (double v = 0.0; v < 360.0; v += 53.7) {
      const Eigen::Vector3d p = kCamera.unproject(u, v, 2.5);
      EXPECT_DOUBLE_EQ(p.z(), 2.5);
      EXPECT_LT((kCamera.project(p) - Eigen::Vector2d(u, v)).norm(), 1e-9);
    }
  }
}

TEST(PinholeCamera, ContainsCountsPixelCentres) {
  EXPECT_TRUE(kCamera.contains({0.0, 0.0}));
  EXPECT_TRUE(kCamera.contains({639.0, 359.0}));
  EXPECT_FALSE(kCamera.contains({639.1, 10.0}));
  EXPECT_FALSE(kCamera.contains({3.9, 10.0}, 4.0));
}

TEST(PinholeCamera, ValidityNeedsSizeAndFocalLength) {
  EXPECT_TRUE(is_valid(kCamera));
  EXPECT_FALSE(is_valid(PinholeCamera{}));
  PinholeCamera flipped = kCamera;
  flipped.fx = -320.0;
  EXPECT_FALSE(is_valid(flipped));
}

}  // namespace
}  // namespace lapis::geometry
