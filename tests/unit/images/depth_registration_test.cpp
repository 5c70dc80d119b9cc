#include "common/images/depth_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapis::images {
namespace {

using geometry::PinholeCamera;
using geometry::Pose;

const PinholeCamera kColor{160, 120, 130.0, 131.0, 79.0, 60.5};

/// Distance along `ray` to a wall that is not square to the view, or to a board 1 m before the camera; the ray has
/// length 1 along the colour camera's axis when it starts there. Infinite when it meets neither.
double meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d normal(0.4, 0.1, 1.0);
  double nearest = (3.0 - normal.dot(origin)) / normal.dot(ray);
  if (nearest <= 0.0) nearest = std::numeric_limits<double>::infinity();
  const double at_board = (1.0 - origin.z()) / ray.z();
  const Eigen::Vector3d p = origin + at_board * ray;
  if (at_board > 0.0 && std::abs(p.x()) < 0.2 && std::abs(p.y()) < 0.15) nearest = std::min(nearest, at_board);
  return nearest;
}

double depth_at(const PinholeCamera& camera, const Pose& T_color_camera, double u, double v) {
  return meet(T_color_camera.translation(), T_color_camera.linear() * camera.unproject(u, v, 1.0));
}

geometry::DepthImage render(const PinholeCamera& camera, const Pose& T_color_camera) {
  geometry::DepthImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) image(u, v) = static_cast<float>(depth_at(camera, T_color_camera, u, v));
  }
  return image;
}

/// True where one of the pixels up to two away has another surface.
bool is_near_edge(const PinholeCamera& camera, const Pose& T_color_camera, double u, double v) {
  const double here = depth_at(camera, T_color_camera, u, v);
  for (const double du : {-2.0, 0.0, 2.0}) {
    for (const double dv : {-2.0, 0.0, 2.0}) {
      if (std::abs(depth_at(camera, T_color_camera, u + du, v + dv) - here) > 0.3) return true;
    }
  }
  return false;
}

struct Verdict {
  int seen_by_both = 0, missing = 0, hidden = 0, invented = 0;
  double largest_error_m = 0.0;
};

/// Compares with what the colour camera would measure itself, away from edges.
Verdict judge(const RgbdCalibration& cameras) {
  const PinholeCamera& depth = cameras.depth.pinhole;
  const geometry::DepthImage result = DepthRegistration(cameras)(render(depth, cameras.T_color_depth));
  EXPECT_EQ(result.width, kColor.width);
  EXPECT_EQ(result.height, kColor.height);
  const Pose here = Pose::Identity();
  Verdict verdict;
  for (int v = 2; v + 2 < kColor.height; ++v) {
    for (int u = 2; u + 2 < kColor.width; ++u) {
      const double truth = depth_at(kColor, here, u, v);
      const Eigen::Vector3d in_depth = cameras.T_color_depth.inverse() * kColor.unproject(u, v, truth);
      const Eigen::Vector2d pixel = depth.project(in_depth);
      if (!depth.contains(pixel, 1.0)) continue;
      if (is_near_edge(kColor, here, u, v) || is_near_edge(depth, cameras.T_color_depth, pixel.x(), pixel.y()))
        continue;
      const bool is_hidden = depth_at(depth, cameras.T_color_depth, pixel.x(), pixel.y()) < in_depth.z() - 0.3;
      const double found = result(u, v);
      if (is_hidden) {
        ++verdict.hidden;
        verdict.invented += found > 0.0 ? 1 : 0;
        continue;
      }
      ++verdict.seen_by_both;
      verdict.missing += found == 0.0F ? 1 : 0;
      if (found > 0.0F) verdict.largest_error_m = std::max(verdict.largest_error_m, std::abs(found - truth));
    }
  }
  return verdict;
}

/// The wall is at 2 to 4 m, and its depth changes by at most 0.4 of what one goes to the side: a pixel is 3 cm wide
/// there and its depth may be off by half of that.
constexpr double kWithinAPixel_m = 0.02;

TEST(DepthRegistration, DepthOfAnotherCameraIsWhatTheColourCameraWouldMeasure) {
  const Pose aside =
      geometry::make_pose({-0.025, 0.004, 0.003}, Eigen::Quaterniond(1.0, 0.003, -0.004, 0.002).normalized());
  const PinholeCamera fine{160, 120, 145.0, 145.0, 81.0, 58.0}, coarse{64, 50, 55.0, 54.0, 30.5, 25.0},
      finer{400, 300, 330.0, 331.0, 199.5, 149.5};
  for (const PinholeCamera& depth : {fine, coarse, finer}) {
    const Verdict verdict = judge({{kColor, {}}, {depth, {}}, aside});
    EXPECT_GT(verdict.seen_by_both, 10'000) << depth.width;
    EXPECT_LE(verdict.missing, verdict.seen_by_both / 1000) << depth.width;
    EXPECT_LT(verdict.largest_error_m, kWithinAPixel_m * kColor.fx / depth.fx + 0.005) << depth.width;
  }
}

TEST(DepthRegistration, WhatOnlyTheColourCameraSeesHasNoDepth) {
  const Pose far_aside = geometry::make_pose({-0.3, 0.0, 0.0}, Eigen::Quaterniond::Identity());
  const Verdict verdict = judge({{kColor, {}}, {kColor, {}}, far_aside});
  EXPECT_GT(verdict.hidden, 200);
  EXPECT_EQ(verdict.invented, 0);
}

TEST(DepthRegistration, RegisteredDepthStaysAsItIs) {
  geometry::DepthImage image = render(kColor, Pose::Identity());
  image(3, 4) = 0.0F;
  const RgbdCalibration cameras{{kColor, {0.1, -0.2, 0.0, 0.0}}, {kColor, {}}};
  EXPECT_TRUE(cameras.is_registered()) << "colour is rectified apart";
  EXPECT_EQ(DepthRegistration(cameras)(image).pixels, image.pixels);
}

TEST(DepthRegistration, TheLensOfTheDepthCameraIsTakenOut) {
  const geometry::LensCamera lens{kColor, {-0.2, 0.03, 0.001, -0.002}};
  geometry::DepthImage image = render(kColor, Pose::Identity()), rectified = image;
  Rectifier(lens).rectify(rectified);
  ASSERT_NE(rectified.pixels, image.pixels);
  EXPECT_EQ(DepthRegistration({{kColor, {}}, lens})(image).pixels, rectified.pixels);
}

TEST(DepthRegistration, PointsBehindOrBesideTheColourCameraAreDropped) {
  const Pose behind = geometry::make_pose({0.0, 0.0, -5.0}, Eigen::Quaterniond::Identity());
  const auto all_behind = DepthRegistration({{kColor, {}}, {kColor, {}}, behind})(render(kColor, Pose::Identity()));
  EXPECT_EQ(std::count(all_behind.pixels.begin(), all_behind.pixels.end(), 0.0F), 160 * 120);
  const geometry::DepthImage huge(kColor.width, kColor.height, std::numeric_limits<float>::max());
  for (const float depth : DepthRegistration({{kColor, {}}, {kColor, {}}, behind})(huge).pixels)
    ASSERT_TRUE(std::isfinite(depth));
}

}  // namespace
}  // namespace lapis::images
