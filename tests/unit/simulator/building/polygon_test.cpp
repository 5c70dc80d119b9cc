#include "simulator/core/scene/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

/// A star-shaped polygon with random radii: simple, counter-clockwise, seldom convex.
Polygon star(std::uint64_t seed, int corners) {
  const Random random(seed, RandomStream::kTexture);
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    const double radius = random.uniform(static_cast<std::uint64_t>(i), 1.0, 3.0);
    polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return polygon;
}

TEST(Polygon, TrianglesOfAnyPolygonShareItsArea) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Polygon polygon = star(seed, 3 + static_cast<int>(seed % 12));
    ASSERT_TRUE(is_simple(polygon));
    double sum = 0.0;
    for (const auto& t : triangulate(polygon)) {
      const double area = signed_area({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
      EXPECT_GT(area, 0.0) << "seed " << seed;
      sum += area;
    }
    EXPECT_NEAR(sum, signed_area(polygon), 1e-9) << "seed " << seed;
  }
}

TEST(Polygon, PiecesOfAGridShareTheArea) {
  const Polygon triangle{{0.1, 0.2}, {2.9, 0.7}, {1.3, 2.8}};
  double sum = 0.0;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      sum += signed_area(clip(triangle, rectangle({0.25 + 0.5 * column, 0.25 + 0.5 * row}, {0.5, 0.5}, 0.0)));
  }
  EXPECT_NEAR(sum, signed_area(triangle), 1e-9);
}

TEST(Polygon, ContainsAgreesWithTheShareOfPointsInside) {
  const Polygon polygon = star(7, 9);
  const Random random(1, RandomStream::kTexture);
  int inside = 0;
  constexpr int kPoints = 40000;
  for (std::uint64_t i = 0; i < kPoints; ++i)
    inside +=
        contains(polygon, Eigen::Vector2d(random.uniform(2 * i, -3, 3), random.uniform(2 * i + 1, -3, 3))) ? 1 : 0;
  EXPECT_NEAR(36.0 * inside / kPoints, signed_area(polygon), 0.4);
}

TEST(Polygon, WhatCutsOrTouchesItselfIsNotSimple) {
  EXPECT_FALSE(is_simple({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));          // a bow
  EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}));  // a corner on an edge
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {1, 0}, {0, 1}}));          // a corner twice
  EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {1, 0}, {1, 1}}));          // folds back
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}}));
  EXPECT_TRUE(is_simple({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}));
}

TEST(Polygon, TurnedRectanglesOverlapWhereTheyShareMoreThanTheBorder) {
  const Polygon unit = rectangle({0, 0}, {1, 1}, 0.0);
  EXPECT_TRUE(overlap(unit, rectangle({0.9, 0}, {1, 1}, 0.0)));
  EXPECT_FALSE(overlap(unit, rectangle({1.0, 0}, {1, 1}, 0.0)));
  const double quarter = std::numbers::pi / 4;  // a diamond reaches 0.707 from its middle
  EXPECT_FALSE(overlap(unit, rectangle({1.21, 0}, {1, 1}, quarter)));
  EXPECT_TRUE(overlap(unit, rectangle({1.2, 0}, {1, 1}, quarter)));
  EXPECT_FALSE(overlap(unit, rectangle({0.87, 0.87}, {1, 1}, quarter)));  // though their boxes overlap
}

TEST(Polygon, ContainsAPolygonUnlessAWallRunsThroughIt) {
  const Polygon bent{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
  EXPECT_TRUE(contains(bent, rectangle({0.5, 0.5}, {1, 1}, 0.0)));
  EXPECT_FALSE(contains(bent, rectangle({0.9, 2}, {0.4, 0.4}, 0.0)));
  EXPECT_FALSE(contains(bent, Polygon{{0.2, 3.5}, {0.1, 0.2}, {3.8, 0.5}}));  // corners inside, an edge outside
}

}  // namespace
}  // namespace lapis::simulator
