#include "sensor_replay/core/rectifier.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lapis::sensor_replay {
namespace {

constexpr int kWidth = 200, kHeight = 150;

CameraFile camera(const std::array<double, 5>& distortion) {
  CameraFile file;
  file.camera = {kWidth, kHeight, 161.0, 158.0, 98.5, 76.2};
  file.distortion = distortion;
  return file;
}

// Where a pixel of the ideal camera lies in the recorded image: the model of Brown (1966) as OpenCV documents it.
std::pair<double, double> distorted(const CameraFile& file, int u, int v) {
  const auto& [k1, k2, p1, p2, k3] = file.distortion;
  const auto& c = file.camera;
  const double x = (u - c.cx) / c.fx, y = (v - c.cy) / c.fy, r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double x_d = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double y_d = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {c.fx * x_d + c.cx, c.fy * y_d + c.cy};
}

bool is_inside(double u, double v) { return u >= 0.0 && v >= 0.0 && u <= kWidth - 1 && v <= kHeight - 1; }

// Recorded images whose pixels hold their own coordinates tell where each rectified pixel was taken from.
TEST(Rectifier, TakesEveryPixelFromWhereTheLensPutIt) {
  const CameraFile file = camera({0.2624, -0.9531, -0.0054, 0.0026, 1.1633});
  geometry::ColorImage color(kWidth, kHeight);
  geometry::Image<std::uint16_t> depth(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      color(u, v) = {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 255};
      depth(u, v) = static_cast<std::uint16_t>(1 + u + kWidth * v);
    }
  }
  const Rectifier rectifier(file);
  rectifier.rectify(color);
  rectifier.rectify(depth);
  double largest_shift = 0.0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto [u_d, v_d] = distorted(file, u, v);
      if (!is_inside(u_d, v_d)) continue;
      largest_shift = std::max(largest_shift, std::hypot(u_d - u, v_d - v));
      ASSERT_NEAR(color(u, v).r, u_d, 0.6) << u << ", " << v;
      ASSERT_NEAR(color(u, v).g, v_d, 0.6) << u << ", " << v;
      const int column = (depth(u, v) - 1) % kWidth, row = (depth(u, v) - 1) / kWidth;
      ASSERT_NEAR(column, u_d, 0.55) << u << ", " << v;
      ASSERT_NEAR(row, v_d, 0.55) << u << ", " << v;
    }
  }
  EXPECT_GT(largest_shift, 3.0);
}

TEST(Rectifier, WhatTheLensDidNotSeeIsEmpty) {
  const CameraFile file = camera({0.3, 0.0, 0.0, 0.0, 0.0});  // the corners lie outside
  geometry::Image<std::uint16_t> labels(kWidth, kHeight, 7);
  Rectifier(file).rectify(labels);
  const auto [u_d, v_d] = distorted(file, 0, 0);
  ASSERT_FALSE(is_inside(u_d, v_d));
  EXPECT_EQ(labels(0, 0), 0);
  EXPECT_EQ(labels(kWidth / 2, kHeight / 2), 7);
}

TEST(Rectifier, WithoutDistortionNothingChanges) {
  geometry::ColorImage image(kWidth, kHeight, {1, 2, 3});
  image(17, 11) = {4, 5, 6};
  const geometry::ColorImage before = image;
  Rectifier(camera({})).rectify(image);
  EXPECT_EQ(image.pixels, before.pixels);
}

}  // namespace
}  // namespace lapis::sensor_replay
