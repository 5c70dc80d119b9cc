#include "common/images/rectifier.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lapis::images {
namespace {

constexpr int kRectifiedWidth = 200, kRectifiedHeight = 150;

geometry::LensCamera camera(const std::vector<double>& distortion) {
  return {{kRectifiedWidth, kRectifiedHeight, 161.0, 158.0, 98.5, 76.2}, distortion};
}

// Where a pixel of the ideal camera lies in the recorded image: the model of Brown (1966) as OpenCV documents it.
std::pair<double, double> distorted(const geometry::LensCamera& camera, int u, int v) {
  std::vector<double> d = camera.distortion;
  d.resize(8, 0.0);
  const auto& c = camera.pinhole;
  const double x = (u - c.cx) / c.fx, y = (v - c.cy) / c.fy, r2 = x * x + y * y;
  const double radial = (1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  const double p1 = d[2], p2 = d[3];
  const double x_d = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double y_d = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {c.fx * x_d + c.cx, c.fy * y_d + c.cy};
}

bool is_inside(double u, double v) {
  return u >= 0.0 && v >= 0.0 && u <= kRectifiedWidth - 1 && v <= kRectifiedHeight - 1;
}

// Recorded images whose pixels hold their own coordinates show where each rectified pixel was taken from.
void expect_pixels_from_where_the_lens_put_them(const geometry::LensCamera& lens) {
  geometry::ColorImage color(kRectifiedWidth, kRectifiedHeight);
  geometry::GrayImage gray(kRectifiedWidth, kRectifiedHeight);
  geometry::Image<std::uint16_t> depth(kRectifiedWidth, kRectifiedHeight);
  geometry::DepthImage metres(kRectifiedWidth, kRectifiedHeight);
  for (int v = 0; v < kRectifiedHeight; ++v) {
    for (int u = 0; u < kRectifiedWidth; ++u) {
      color(u, v) = {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 255};
      gray(u, v) = static_cast<std::uint8_t>(u);
      depth(u, v) = static_cast<std::uint16_t>(1 + u + kRectifiedWidth * v);
      metres(u, v) = static_cast<float>(depth(u, v));
    }
  }
  const Rectifier rectifier(lens);
  rectifier.rectify(color);
  rectifier.rectify(gray);
  rectifier.rectify(depth);
  rectifier.rectify(metres);
  double largest_shift = 0.0;
  for (int v = 0; v < kRectifiedHeight; ++v) {
    for (int u = 0; u < kRectifiedWidth; ++u) {
      const auto [u_d, v_d] = distorted(lens, u, v);
      if (!is_inside(u_d, v_d)) continue;
      largest_shift = std::max(largest_shift, std::hypot(u_d - u, v_d - v));
      ASSERT_NEAR(color(u, v).r, u_d, 0.6) << u << ", " << v;
      ASSERT_NEAR(color(u, v).g, v_d, 0.6) << u << ", " << v;
      ASSERT_EQ(gray(u, v), color(u, v).r) << u << ", " << v;
      ASSERT_EQ(metres(u, v), static_cast<float>(depth(u, v))) << u << ", " << v;
      const int column = (depth(u, v) - 1) % kRectifiedWidth, row = (depth(u, v) - 1) / kRectifiedWidth;
      ASSERT_NEAR(column, u_d, 0.55) << u << ", " << v;
      ASSERT_NEAR(row, v_d, 0.55) << u << ", " << v;
    }
  }
  EXPECT_GT(largest_shift, 3.0);
}

TEST(Rectifier, TakesEveryPixelFromWhereTheLensPutIt) {
  expect_pixels_from_where_the_lens_put_them(camera({0.2624, -0.9531, -0.0054, 0.0026, 1.1633}));
  expect_pixels_from_where_the_lens_put_them(camera({-0.25, 0.04, 0.001, -0.002}));
  expect_pixels_from_where_the_lens_put_them(camera({0.4, -2.4, 0.0006, -0.0002, 1.3, 0.1, -2.0, 1.1}));
}

TEST(Rectifier, WhatTheLensDidNotSeeIsEmpty) {
  const geometry::LensCamera lens = camera({0.3, 0.0, 0.0, 0.0, 0.0});  // the corners lie outside
  geometry::Image<std::uint16_t> labels(kRectifiedWidth, kRectifiedHeight, 7);
  Rectifier(lens).rectify(labels);
  const auto [u_d, v_d] = distorted(lens, 0, 0);
  ASSERT_FALSE(is_inside(u_d, v_d));
  EXPECT_EQ(labels(0, 0), 0);
  EXPECT_EQ(labels(kRectifiedWidth / 2, kRectifiedHeight / 2), 7);
}

TEST(Rectifier, WithoutDistortionNothingChanges) {
  geometry::ColorImage image(kRectifiedWidth, kRectifiedHeight, {1, 2, 3});
  image(17, 11) = {4, 5, 6};
  const geometry::ColorImage before = image;
  Rectifier(camera({})).rectify(image);
  EXPECT_EQ(image.pixels, before.pixels);
}

}  // namespace
}  // namespace lapis::images
