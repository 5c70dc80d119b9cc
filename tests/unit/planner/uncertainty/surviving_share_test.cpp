#include "planner/core/uncertainty/surviving_share.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace lapis::planner {
namespace {

constexpr double kEdge_m = 0.25;

/// The mean of what is left over a normal error, by sums.
double share_by_sums(double sigma_m) {
  constexpr int kSteps = 200'000;
  double sum = 0.0, weights = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = -8.0 + 16.0 * (i + 0.5) / kSteps, weight = std::exp(-0.5 * z * z);
    sum += weight * std::max(0.0, 1.0 - std::abs(z) * sigma_m / kEdge_m);
    weights += weight;
  }
  return sum / weights;
}

TEST(SurvivingShare, IsTheMeanOverANormalError) {
  for (const double sigma_m : {0.001, 0.05, 0.1, 0.2, 0.5, 3.0})
    EXPECT_NEAR(surviving_share(sigma_m, kEdge_m), share_by_sums(sigma_m), 1e-6) << sigma_m;
  EXPECT_NEAR(surviving_share(0.05, kEdge_m), 0.840, 5e-4);
  EXPECT_EQ(surviving_share(0.0, kEdge_m), 1.0);
  EXPECT_EQ(surviving_share(std::numeric_limits<double>::infinity(), kEdge_m), 0.0);
}

TEST(SurvivingShare, OfADisplacementIsTheMeanOverNormals) {
  for (const double length_m : {0.0, 0.01, 0.1, 0.25, 0.2501, 0.4, 2.0}) {
    constexpr int kSteps = 100'000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double normal = 2.0 * std::numbers::pi * (i + 0.5) / kSteps;
      sum += std::max(0.0, 1.0 - std::abs(length_m * std::cos(normal)) / kEdge_m);
    }
    const Eigen::Vector2d displacement_m = Eigen::Rotation2Dd(0.7) * Eigen::Vector2d(length_m, 0.0);
    EXPECT_NEAR(surviving_share_of(displacement_m, kEdge_m), sum / kSteps, 1e-6) << length_m;
  }
}

// A heading that is off by 0.1 rad moves what is 3 m ahead by 0.3 m aside; half of all normals see it.
TEST(SurfaceSigma, GrowsWithTheLeverOfTheHeading) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(2, 2) = 0.01;
  EXPECT_NEAR(surface_sigma_m(covariance, Eigen::Vector3d(0.0, -2.0, 0.5), 3.0), 0.3 / std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(surface_sigma_m(covariance, Eigen::Vector3d(1.0, 0.0, 0.0), 0.0), 0.0);
  covariance(0, 0) = covariance(1, 1) = 0.04;
  EXPECT_NEAR(surface_sigma_m(covariance, Eigen::Vector3d(1.0, 0.0, 0.0), 0.0), 0.2, 1e-12);
  // Aside of what the heading does: both errors cancel where the position moves against the turn.
  covariance(1, 2) = covariance(2, 1) = -0.02;
  EXPECT_NEAR(surface_sigma_m(covariance, Eigen::Vector3d(1.0, 0.0, 0.0), 2.0), 0.2 / std::numbers::sqrt2, 1e-12);
}

}  // namespace
}  // namespace lapis::planner
