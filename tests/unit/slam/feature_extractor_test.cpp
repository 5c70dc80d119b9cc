#include "slam/core/frame/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "slam/core/frame/pixel_noise.hpp"
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

// A square that is a little brighter than the wall behind it, a little turned, with a camera's noise.
const Eigen::Vector2d kSquareMiddle(160.0, 120.0);
constexpr double kSquareHalf_px = 60.0, kSquareTurn_rad = 0.15;

Eigen::Vector2d in_square(const Eigen::Vector2d& pixel) {
  return Eigen::Rotation2Dd(-kSquareTurn_rad) * (pixel - kSquareMiddle);
}

geometry::GrayImage noisy_square(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 3.0);
  geometry::GrayImage image(320, 240);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double outside_px = in_square({x, y}).cwiseAbs().maxCoeff() - kSquareHalf_px;
      const double value = 60.0 + 40.0 * std::clamp(0.5 - outside_px, 0.0, 1.0);
      image(x, y) = static_cast<std::uint8_t>(std::lround(value + noise(random)));
    }
  }
  return image;
}

struct OnSquare {
  int corners = 0, sides = 0;
};

OnSquare features_of_squares(const FeatureConfig& config) {
  OnSquare count;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    for (const Feature& feature : FeatureExtractor(config).extract(noisy_square(seed))) {
      const Eigen::Vector2d from_corner = in_square(feature.pixel).cwiseAbs().array() - kSquareHalf_px;
      if (from_corner.norm() < 10.0) {
        ++count.corners;
      } else if (std::abs(from_corner.maxCoeff()) < 5.0) {
        ++count.sides;
      }
    }
  }
  return count;
}

TEST(FeatureExtractor, LeavesOutMostOfWhatNoiseMakesOfEdges) {
  FeatureConfig config;
  const OnSquare fixed = features_of_squares(config);
  config.min_corner_share = 0.0;
  const OnSquare all = features_of_squares(config);
  EXPECT_GT(all.sides, 100);
  EXPECT_LT(fixed.sides, 0.3 * all.sides);
  EXPECT_GE(fixed.corners, 0.9 * all.corners);
}

// An image with this share of its contrast about 40 grey levels, and a camera's noise.
geometry::GrayImage dimmed(const geometry::GrayImage& bright, double contrast, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, sigma);
  geometry::GrayImage image(bright.width, bright.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double value = 40.0 + contrast * (bright.pixels[i] - 128.0) + noise(random);
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
  return image;
}

// Share of the features that lie where the bright image has corners.
double share_at_corners(const std::vector<Feature>& features, const geometry::GrayImage& bright) {
  FeatureConfig config;
  config.max_features = 5000;
  const auto corners = FeatureExtractor(config).extract(bright);
  const auto is_at_corner = [&](const Feature& feature) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Feature& corner) { return (corner.pixel - feature.pixel).norm() < 3.0; });
  };
  return static_cast<double>(std::count_if(features.begin(), features.end(), is_at_corner)) /
         static_cast<double>(features.size());
}

TEST(FeatureExtractor, FindsCornersOfLittleContrast) {
  const auto bright = test::render_room(test::small_camera(), test::room_path(0), {}).gray;
  std::vector<Feature> everywhere;
  for (int y = 20; y < bright.height - 20; ++y) {
    for (int x = 20; x < bright.width - 20; ++x) everywhere.emplace_back().pixel = Eigen::Vector2d(x, y);
  }
  const double chance = share_at_corners(everywhere, bright);
  for (const double sigma : {0.0, 0.5}) {
    const auto features = FeatureExtractor({}).extract(dimmed(bright, 0.06, sigma));
    EXPECT_GT(features.size(), 200U) << sigma;
    EXPECT_GT(share_at_corners(features, bright), 0.5 * (1.0 + chance)) << sigma;
  }
}

TEST(FeatureExtractor, TakesNoNoiseForCorners) {
  for (const double sigma : {0.2, 0.5, 1.0, 2.0}) {
    const geometry::GrayImage flat = dimmed(geometry::GrayImage(640, 480, 128), 1.0, sigma);
    EXPECT_LT(FeatureExtractor({}).extract(flat).size(), 30U) << sigma;
  }
}

double noise_of(const geometry::GrayImage& image) {
  return pixel_noise({image.pixels.data(), image.width, image.height, static_cast<std::size_t>(image.width)});
}

TEST(PixelNoise, IsThatOfTheCameraNotOfTheScene) {
  constexpr double kRounding2 = 1.0 / 12.0;
  const auto bright = test::render_room(test::small_camera(), test::room_path(0), {}).gray;
  geometry::GrayImage ramp(320, 240);
  for (int y = 0; y < ramp.height; ++y) {
    for (int x = 0; x < ramp.width; ++x) ramp(x, y) = static_cast<std::uint8_t>(100 + x / 4 - y / 8);
  }
  for (const double sigma : {1.0, 2.0, 4.0}) {
    const double expected = std::sqrt(sigma * sigma + kRounding2);
    EXPECT_NEAR(noise_of(dimmed(ramp, 1.0, sigma)), expected, 0.15 * expected) << sigma;
    EXPECT_NEAR(noise_of(dimmed(bright, 0.5, sigma)), expected, 0.3 * expected) << sigma;
  }
}

TEST(PixelNoise, IsAtLeastThatOfRounding) {
  const double rounding = std::sqrt(1.0 / 12.0);
  for (const int value : {0, 128, 255}) {
    EXPECT_DOUBLE_EQ(noise_of(geometry::GrayImage(64, 64, static_cast<std::uint8_t>(value))), rounding);
  }
  EXPECT_DOUBLE_EQ(noise_of(geometry::GrayImage(2, 2, 7)), rounding);
}

TEST(PixelNoise, IsNotCutOffInTheDark) {
  // Most of the image is black, with the noise cut off; a grey stripe shows it.
  geometry::GrayImage image = dimmed(geometry::GrayImage(320, 240, 0), 0.0, 2.0);
  for (int y = 0; y < 160; ++y) std::fill_n(&image(0, y), image.width, std::uint8_t{0});
  EXPECT_NEAR(noise_of(image), 2.0, 0.3);
}

}  // namespace
}  // namespace lapis::slam
