#include "slam/core/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

std::vector<Corner> clustered_corners(int count) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> near(0, 39), x(0, 319), y(0, 239), score(1, 1000);
  std::vector<Corner> corners;
  for (int i = 0; i < count; ++i) corners.push_back({near(random), near(random), 1000.0F + static_cast<float>(i)});
  for (int i = 0; i < count / 10; ++i) corners.push_back({x(random), y(random), static_cast<float>(score(random))});
  return corners;
}

TEST(SpreadCorners, GivesEveryCellItsBestCornerFirst) {
  const auto corners = clustered_corners(2000);
  const int count = 100;
  const auto chosen = spread_corners(corners, 320, 240, count);
  ASSERT_EQ(chosen.size(), 100U);
  const double cell = std::sqrt(320.0 * 240.0 / count);
  const auto cell_of = [&](const Corner& c) { return std::pair(int(c.x / cell), int(c.y / cell)); };
  std::set<std::pair<int, int>> occupied, covered;
  for (const Corner& corner : corners) occupied.insert(cell_of(corner));
  for (const Corner& corner : chosen) covered.insert(cell_of(corner));
  EXPECT_EQ(covered.size(), std::min(occupied.size(), chosen.size()));
  for (std::size_t i = 0; i < covered.size(); ++i) {
    for (const Corner& other : corners) {
      if (cell_of(other) == cell_of(chosen[i])) {
        EXPECT_LE(other.score, chosen[i].score);
      }
    }
  }
}

TEST(SpreadCorners, DoesNotDependOnTheOrderOfItsInput) {
  auto corners = clustered_corners(500);
  const auto first = spread_corners(corners, 320, 240, 80);
  std::shuffle(corners.begin(), corners.end(), std::mt19937(5));
  const auto second = spread_corners(corners, 320, 240, 80);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(std::tuple(first[i].x, first[i].y, first[i].score),
              std::tuple(second[i].x, second[i].y, second[i].score));
  }
}

TEST(SpreadCorners, TakesAllWhenThereAreFew) {
  EXPECT_TRUE(spread_corners({}, 320, 240, 10).empty());
  EXPECT_TRUE(spread_corners({{1, 1, 1.0F}}, 320, 240, 0).empty());
  EXPECT_EQ(spread_corners({{1, 1, 1.0F}, {2, 2, 2.0F}}, 320, 240, 10).size(), 2U);
}

TEST(FeatureExtractor, CoversTheImageWithinItsBudget) {
  const auto camera = test::small_camera();
  FeatureConfig config;
  config.max_features = 300;
  const auto frame = test::render_room(camera, test::room_path(0), {});
  const auto features = FeatureExtractor(config).extract(frame.gray);
  EXPECT_GT(features.size(), 250U);
  EXPECT_LE(features.size(), 305U);  // rounding per level
  std::set<std::pair<int, int>> covered;
  for (const Feature& feature : features) {
    EXPECT_TRUE(camera.contains(feature.pixel));
    covered.insert({int(feature.pixel.x() / 40), int(feature.pixel.y() / 40)});
  }
  EXPECT_GE(covered.size(), 40U);  // of 8 x 6 cells of 40 px
}

TEST(FeatureExtractor, FindsNothingWhereThereIsNothing) {
  const FeatureExtractor extractor{FeatureConfig{}};
  EXPECT_TRUE(extractor.extract(geometry::GrayImage(320, 240, 0)).empty());
  EXPECT_TRUE(extractor.extract(geometry::GrayImage(8, 8, 0)).empty());
  EXPECT_TRUE(extractor.extract(geometry::GrayImage()).empty());
}

}  // namespace
}  // namespace lapis::slam
