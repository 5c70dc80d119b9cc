#include "simulator/core/noise/color_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulator/core/noise/depth_noise.hpp"
#include "simulator/core/noise/motion_blur.hpp"
#include "simulator/core/noise/normal_table.hpp"
#include "simulator/core/noise/random.hpp"
#include "statistics.hpp"

namespace lapis::simulator {
namespace {

using geometry::ColorImage;
using geometry::Rgb8;

ColorNoiseConfig quiet() {
  ColorNoiseConfig config;
  config.sigma = 0.0;
  return config;
}

ColorImage random_image(int width, int height) {
  ColorImage image(width, height);
  const Random random(5, RandomStream::kTruth);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint64_t bits = random.bits(i);
    image.pixels[i] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
                       static_cast<std::uint8_t>(bits >> 16U)};
  }
  return image;
}

std::vector<double> channel(const ColorImage& image, std::uint8_t Rgb8::*member) {
  std::vector<double> all;
  for (const Rgb8& pixel : image.pixels) all.push_back(pixel.*member);
  return all;
}

TEST(NormalTable, HasTheQuantilesOfTheNormalDistribution) {
  const auto& values = NormalTable::get().values();
  const std::vector<double> all(values.begin(), values.end());
  EXPECT_NEAR(mean_of(all), 0.0, 1e-9);
  EXPECT_NEAR(variance_of(all), 1.0, 1e-6);
  for (std::size_t i = 1; i + 1 < all.size(); ++i)
    ASSERT_NEAR(normal_cdf(all[i]), (static_cast<double>(i) + 0.5) / 4096, 2e-4) << i;
  double fourth = 0.0;
  for (const double x : all) fourth += std::pow(x, 4) / 4096;
  EXPECT_NEAR(fourth, 3.0, 0.05);
}

TEST(ColorNoise, WithoutAnythingIsTheIdentity) {
  const ColorImage image = random_image(64, 48);
  EXPECT_EQ(ColorNoise(quiet(), 3).apply(image, 9, {20, 5}).pixels, image.pixels);
}

TEST(ColorNoise, SpreadsEveryChannelForItself) {
  const ColorImage image(300, 200, {100, 128, 150});
  for (const double sigma : {1.0, 2.5, 8.0}) {
    ColorNoiseConfig config;
    config.sigma = sigma;
    const ColorImage noisy = ColorNoise(config, 3).apply(image, 9);
    const auto r = channel(noisy, &Rgb8::r), g = channel(noisy, &Rgb8::g), b = channel(noisy, &Rgb8::b);
    const double expected = sigma * sigma + 1.0 / 12, n = static_cast<double>(r.size());
    EXPECT_NEAR(mean_of(r), 100, kSigmas * std::sqrt(expected / n));
    EXPECT_NEAR(mean_of(g), 128, kSigmas * std::sqrt(expected / n));
    EXPECT_NEAR(mean_of(b), 150, kSigmas * std::sqrt(expected / n));
    for (const auto* c : {&r, &g, &b}) EXPECT_NEAR(variance_of(*c) / expected, 1.0, variance_bound(c->size())) << sigma;
    const double bound = kSigmas / std::sqrt(n);
    EXPECT_LT(std::abs(correlation_of(r, g)), bound);
    EXPECT_LT(std::abs(correlation_of(g, b)), bound);
    EXPECT_LT(std::abs(correlation_of({r.begin() + 1, r.end()}, {r.begin(), r.end() - 1})), bound);
  }
}

TEST(ColorNoise, EndsAtBlackAndWhite) {
  ColorNoiseConfig config;
  config.sigma = 30.0;
  const ColorImage noisy = ColorNoise(config, 3).apply(ColorImage(300, 200, {0, 255, 3}), 9);
  for (const Rgb8& pixel : noisy.pixels) {
    ASSERT_LE(pixel.r, 30 * 3.7 + 1);
    ASSERT_GE(pixel.g, 255 - 30 * 3.7 - 1);
  }
}

TEST(ColorNoise, DependsOnSeedAndTickAlone) {
  const ColorImage image(100, 100, {100, 128, 150});
  const ColorNoise noise({}, 3), other({}, 4);
  const ColorImage first = noise.apply(image, 5), next = noise.apply(image, 6);
  EXPECT_EQ(noise.apply(image, 5).pixels, first.pixels);
  EXPECT_NE(other.apply(image, 5).pixels, first.pixels);
  const double bound = kSigmas / 100;
  EXPECT_LT(std::abs(correlation_of(channel(first, &Rgb8::r), channel(next, &Rgb8::r))), bound);
}

TEST(ColorNoise, IsIndependentOfDepthNoise) {
  DepthNoiseConfig depth_config;
  depth_config.model = DepthModel::kRealsense;
  const auto depth =
      DepthNoise(depth_config, 3).apply({100, 100, 3.0F}, geometry::Image<float>(100, 100, 1.0F), 320, 5);
  const ColorImage color = ColorNoise({}, 3).apply(ColorImage(100, 100, {100, 128, 150}), 5);
  const std::vector<double> z(depth.pixels.begin(), depth.pixels.end());
  for (const auto member : {&Rgb8::r, &Rgb8::g, &Rgb8::b})
    EXPECT_LT(std::abs(correlation_of(z, channel(color, member))), kSigmas / 100);
}

TEST(ColorNoise, ContrastShrinksDifferencesFromGrey) {
  ColorNoiseConfig config = quiet();
  config.contrast = 0.5;
  const ColorImage image = random_image(64, 48), result = ColorNoise(config, 3).apply(image, 9);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    ASSERT_NEAR(result.pixels[i].g, 127.5 + 0.5 * (image.pixels[i].g - 127.5), 0.51);
}

/// Straightforward mean over the pixels of a line.
double mean_on_line(const ColorImage& image, int column, int row, const Eigen::Vector2d& step, int half) {
  double sum = 0.0;
  for (int i = -half; i <= half; ++i) {
    const int x = std::clamp(column + static_cast<int>(std::round(i * step.x())), 0, image.width - 1);
    const int y = std::clamp(row + static_cast<int>(std::round(i * step.y())), 0, image.height - 1);
    sum += image(x, y).b;
  }
  return sum / (2 * half + 1);
}

TEST(MotionBlur, IsTheMeanOfALine) {
  const ColorImage image = random_image(90, 40);
  const std::vector<Eigen::Vector2d> lines{{8, 0},   {-8, 0}, {0, 6},  {12, 4},   {12, -4},
                                           {-3, 11}, {5, 5},  {63, 2}, {500, 300}};
  for (const Eigen::Vector2d& line : lines) {
    const ColorImage blurred = motion_blurred(image, line);
    const double length = line.lpNorm<Eigen::Infinity>();
    const int half = static_cast<int>(std::round(std::min(length, 64.0) / 2));
    for (int row = 0; row < image.height; ++row)
      for (int column = 0; column < image.width; ++column)
        ASSERT_NEAR(blurred(column, row).b, mean_on_line(image, column, row, line / length, half), 0.5001)
            << line.transpose() << " at " << column << ", " << row;
  }
}

TEST(MotionBlur, LeavesEvenAreasAsTheyAre) {
  for (const int grey : {0, 1, 127, 254, 255}) {
    const auto level = static_cast<std::uint8_t>(grey);
    const ColorImage image(50, 30, {level, level, level});
    for (double length = 0; length < 70; length += 1)
      ASSERT_EQ(motion_blurred(image, {length, 0.3 * length}).pixels, image.pixels) << length;
  }
}

TEST(MotionBlur, NeedsMotion) {
  const ColorImage image = random_image(30, 20);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(motion_blurred(image, {0.9, 0.0}).pixels, image.pixels);
  EXPECT_EQ(motion_blurred(image, {nan, 5.0}).pixels, image.pixels);
  EXPECT_EQ(motion_blurred(image, {5.0, infinity}).pixels, image.pixels);
  EXPECT_TRUE(motion_blurred({}, {5.0, 5.0}).empty());
}

TEST(ColorNoise, BlursWhileTheShutterIsOpen) {
  ColorNoiseConfig config = quiet();
  config.shutter = 0.25;
  const ColorImage image = random_image(64, 48);
  EXPECT_EQ(ColorNoise(config, 3).apply(image, 9, {24, -8}).pixels, motion_blurred(image, {6, -2}).pixels);
  EXPECT_NE(ColorNoise(config, 3).apply(image, 9, {24, -8}).pixels, image.pixels);
}

}  // namespace
}  // namespace lapis::simulator
