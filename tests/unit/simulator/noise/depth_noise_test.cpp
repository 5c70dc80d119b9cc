#include "simulator/core/noise/depth_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulator/core/noise/random.hpp"
#include "statistics.hpp"

namespace lapis::simulator {
namespace {

using geometry::DepthImage;
using testing::Each;

constexpr double kDegree = std::numbers::pi / 180.0, kFocal_px = 320.0;
constexpr int kSize = 200;
using Cosines = geometry::Image<float>;
using Millimetres = geometry::Image<std::uint16_t>;

DepthNoiseConfig config_of(DepthModel model) {
  DepthNoiseConfig config;
  config.model = model;
  return config;
}

DepthImage flat(double depth_m, int width = kSize, int height = kSize) {
  return {width, height, static_cast<float>(depth_m)};
}
Cosines facing(const DepthImage& depth, double angle_deg = 0.0) {
  return {depth.width, depth.height, static_cast<float>(std::cos(angle_deg * kDegree))};
}

Millimetres measure(const DepthNoiseConfig& config, const DepthImage& depth, double angle_deg = 0.0,
                    std::uint64_t tick = 1, std::uint64_t seed = 7) {
  return DepthNoise(config, seed).apply(depth, facing(depth, angle_deg), kFocal_px, tick);
}

std::vector<double> metres(const Millimetres& image) {
  std::vector<double> all;
  for (const std::uint16_t mm : image.pixels) all.push_back(1e-3 * mm);
  return all;
}

double share_of_none(const Millimetres& image, int first_column, int last_column) {
  int none = 0;
  for (int row = 0; row < image.height; ++row)
    for (int column = first_column; column <= last_column; ++column) none += image(column, row) == 0 ? 1 : 0;
  return static_cast<double>(none) / (image.height * (last_column - first_column + 1));
}

constexpr double kRounding_m2 = 1e-6 / 12;  // variance of rounding to millimetres

/// Nguyen et al. 2012, written down again.
double kinect_sigma_m(double z, double theta) {
  const double axial = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
  if (theta <= 60 * kDegree) return axial;
  return axial + 0.0001 / std::sqrt(z) * theta * theta / std::pow(std::numbers::pi / 2 - theta, 2);
}
double kinect_lateral_px(double theta) { return 0.8 + 0.035 * theta / (std::numbers::pi / 2 - theta); }

TEST(DepthNoise, NoneIsTheIdealDepthInMillimetres) {
  DepthImage depth(100, 50);
  const Random random(3, RandomStream::kTruth);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<float>(random.uniform(i, 0.01, 65.0));
  depth(3, 4) = 0.0F;
  depth(5, 6) = 70.0F;  // beyond what 16 bits hold
  const Millimetres result = measure(config_of(DepthModel::kNone), depth, 89.0);
  EXPECT_EQ(result(3, 4), 0);
  EXPECT_EQ(result(5, 6), 0);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    if (result.pixels[i] == 0) continue;
    ASSERT_NEAR(result.pixels[i], depth.pixels[i] * 1e3, 0.51);
  }
  EXPECT_EQ(std::count(result.pixels.begin(), result.pixels.end(), 0), 2);
}

TEST(DepthNoise, KinectSpreadsAsNguyenMeasured) {
  for (const double z : {0.5, 1.0, 2.0, 3.5, 5.5}) {
    for (const double angle_deg : {0.0, 30.0, 58.0, 62.0, 70.0, 78.0}) {
      const auto samples = metres(measure(config_of(DepthModel::kKinect), flat(z), angle_deg));
      const double sigma = kinect_sigma_m(z, angle_deg * kDegree), expected = sigma * sigma + kRounding_m2;
      EXPECT_NEAR(variance_of(samples) / expected, 1.0, variance_bound(samples.size())) << z << " m " << angle_deg;
      EXPECT_NEAR(mean_of(samples), z, kSigmas * std::sqrt(expected / static_cast<double>(samples.size())));
    }
  }
}

/// Mean of the squared errors that axial noise does not explain, on a ramp of 60 pixels along x or y.
double unexplained_m2(bool is_down, double slope_m_px, double angle_deg) {
  constexpr int kLength = 60, kBreadth = 400, kBorder = 6;  // the border cuts the jitter off
  DepthImage ramp(is_down ? kBreadth : kLength, is_down ? kLength : kBreadth);
  const auto along = [&](int column, int row) { return is_down ? row : column; };
  for (int row = 0; row < ramp.height; ++row)
    for (int column = 0; column < ramp.width; ++column)
      ramp(column, row) = static_cast<float>(0.4 + slope_m_px * along(column, row));
  const Millimetres measured = measure(config_of(DepthModel::kKinect), ramp, angle_deg);
  std::vector<double> squares;
  for (int row = 0; row < ramp.height; ++row) {
    for (int column = 0; column < ramp.width; ++column) {
      if (along(column, row) < kBorder || along(column, row) >= kLength - kBorder) continue;
      const double z = ramp(column, row), axial_m = kinect_sigma_m(z, angle_deg * kDegree);
      squares.push_back(std::pow(1e-3 * measured(column, row) - z, 2) - axial_m * axial_m);
    }
  }
  return mean_of(squares);
}

TEST(DepthNoise, KinectJittersAcrossTheRay) {
  const double slope_m_px = 0.01;
  for (const double angle_deg : {0.0, 75.0}) {
    const double sigma_px = kinect_lateral_px(angle_deg * kDegree);
    const double expected = slope_m_px * slope_m_px * (sigma_px * sigma_px + 1.0 / 12);  // to whole pixels
    for (const bool is_down : {false, true}) {
      EXPECT_NEAR(unexplained_m2(is_down, slope_m_px, angle_deg) / expected, 1.0, variance_bound(48 * 400))
          << angle_deg << " degrees, " << (is_down ? "down" : "across");
    }
  }
}

TEST(DepthNoise, RedwoodRoundsNoisyDisparityToEighths) {
  for (const double z : {0.8, 1.7, 3.3, 5.0}) {
    const auto samples = metres(measure(config_of(DepthModel::kRedwood), flat(z)));
    const double steps = 8 * 35.130 / z, sigma = 8 * 0.027778;
    double total = 0.0;
    for (double k = std::floor(steps) - 2; k <= std::ceil(steps) + 2; ++k) {
      const double expected = normal_cdf((k + 0.5 - steps) / sigma) - normal_cdf((k - 0.5 - steps) / sigma);
      const double depth_m = std::round(8e3 * 35.130 / k) * 1e-3;
      const auto hits = std::count_if(samples.begin(), samples.end(),
                                      [&](double sample) { return std::abs(sample - depth_m) < 1e-6; });
      const double share = static_cast<double>(hits) / static_cast<double>(samples.size());
      EXPECT_NEAR(share, expected, share_bound(expected, samples.size())) << z << " m, step " << k;
      total += share;
    }
    EXPECT_NEAR(total, 1.0, 1e-12) << "depths off the grid at " << z << " m";
  }
}

TEST(DepthNoise, RedwoodReadsEverySecondPixelWithJitter) {
  DepthImage even(kSize, kSize, 1.05F), stripes(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      if (column % 2 == 0 && row % 2 == 0) even(column, row) = 1.0F;
      stripes(column, row) = column / 2 % 2 == 0 ? 1.0F : 1.05F;  // two pixels wide
    }
  }
  EXPECT_THAT(measure(config_of(DepthModel::kRedwood), even).pixels, Each(testing::Lt(1025)));
  const Millimetres result = measure(config_of(DepthModel::kRedwood), stripes);
  int wrong = 0;
  for (int row = 0; row < kSize; ++row)
    for (int column = 2; column < kSize - 2; ++column)
      wrong += (result(column, row) < 1025) != (stripes(column, row) < 1.025F) ? 1 : 0;
  const std::size_t n = std::size_t{kSize} * (kSize - 4);
  const double expected = 1 - normal_cdf(0.5 / 0.25);  // half a pixel towards the nearer stripe
  EXPECT_NEAR(wrong / static_cast<double>(n), expected, share_bound(expected, n));
}

TEST(DepthNoise, RedwoodSeesNothingFromTenMetresOn) {
  DepthNoiseConfig config = config_of(DepthModel::kRedwood);
  config.max_range_m = 20.0;
  EXPECT_THAT(measure(config, flat(11.0)).pixels, Each(0));
  EXPECT_THAT(measure(config, flat(9.0)).pixels, Each(testing::Gt(8000)));
}

TEST(DepthNoise, RealsenseSpreadsWithDepthSquared) {
  for (const double focal_px : {320.0, 600.0}) {
    for (const double z : {0.8, 2.0, 4.0, 5.0}) {
      const DepthImage depth = flat(z);
      const auto samples =
          metres(DepthNoise(config_of(DepthModel::kRealsense), 7).apply(depth, facing(depth), focal_px, 1));
      const double sigma = 0.08 * z * z / (focal_px * 0.05), expected = sigma * sigma + kRounding_m2;
      EXPECT_NEAR(variance_of(samples) / expected, 1.0, variance_bound(samples.size())) << z << " m, f " << focal_px;
      EXPECT_NEAR(mean_of(samples), z, kSigmas * std::sqrt(expected / static_cast<double>(samples.size())));
    }
  }
}

TEST(DepthNoise, MultiplierScalesStandardDeviations) {
  for (const DepthModel model : {DepthModel::kKinect, DepthModel::kRealsense}) {
    DepthNoiseConfig config = config_of(model);
    const double once = variance_of(metres(measure(config, flat(3.0)))) - kRounding_m2;
    config.noise_multiplier = 3.0;
    const double thrice = variance_of(metres(measure(config, flat(3.0)))) - kRounding_m2;
    EXPECT_NEAR(thrice / once, 9.0, 0.05);  // the same draws
    config.noise_multiplier = 0.0;
    EXPECT_THAT(measure(config, flat(3.0)).pixels, Each(3000));
  }
}

class AnyModel : public testing::TestWithParam<DepthModel> {};
INSTANTIATE_TEST_SUITE_P(DepthNoise, AnyModel,
                         testing::Values(DepthModel::kKinect, DepthModel::kRedwood, DepthModel::kRealsense));

TEST_P(AnyModel, DropsEdges) {
  const auto step = [](double far_m) {
    DepthImage depth = flat(1.0, 100, 2000);
    for (int row = 0; row < depth.height; ++row)
      for (int column = 50; column < depth.width; ++column) depth(column, row) = static_cast<float>(far_m);
    return depth;
  };
  DepthNoiseConfig config = config_of(GetParam());
  const Millimetres steep = measure(config, step(1.1));
  EXPECT_NEAR(share_of_none(steep, 49, 50), 0.4, share_bound(0.4, 4000));
  EXPECT_EQ(share_of_none(steep, 0, 48), 0.0);
  EXPECT_EQ(share_of_none(steep, 51, 99), 0.0);
  EXPECT_EQ(share_of_none(measure(config, step(1.07)), 0, 99), 0.0);
  config.extra_dropout = 0.3;
  const Millimetres more = measure(config, step(1.1));
  EXPECT_NEAR(share_of_none(more, 49, 50), 1 - 0.6 * 0.7, share_bound(0.58, 4000));
  EXPECT_NEAR(share_of_none(more, 0, 48), 0.3, share_bound(0.3, 49 * 2000));
}

TEST_P(AnyModel, DropsEdgesBetweenRowsAndToNothing) {
  DepthImage depth = flat(1.0, 2000, 30);
  for (int column = 0; column < depth.width; ++column) {
    for (int row = 10; row < 24; ++row) depth(column, row) = 1.5F;
    for (int row = 24; row < 30; ++row) depth(column, row) = 0.0F;
  }
  const Millimetres result = measure(config_of(GetParam()), depth);
  const auto share = [&](int row) {
    return static_cast<double>(std::count(&result(0, row), &result(0, row) + 2000, 0)) / 2000;
  };
  for (const int row : {0, 3, 8, 11, 17}) EXPECT_EQ(share(row), 0.0) << row;
  for (const int row : {24, 29}) EXPECT_EQ(share(row), 1.0) << row;
  for (const int row : {9, 10}) EXPECT_NEAR(share(row), 0.4, share_bound(0.4, 2000)) << row;
  EXPECT_GT(share(23), 0.35);  // jitter may fall on nothing besides
}

TEST_P(AnyModel, DropsWhatIsGrazed) {
  EXPECT_THAT(measure(config_of(GetParam()), flat(2.0), 80.5).pixels, Each(0));
  EXPECT_THAT(measure(config_of(GetParam()), flat(2.0), 79.5).pixels, Each(testing::Gt(0)));
}

TEST_P(AnyModel, KeepsItsRange) {
  EXPECT_THAT(measure(config_of(GetParam()), flat(0.29)).pixels, Each(0));
  EXPECT_THAT(measure(config_of(GetParam()), flat(6.01)).pixels, Each(0));
  const auto at_the_limit = measure(config_of(GetParam()), flat(5.99)).pixels;
  EXPECT_THAT(at_the_limit, Each(testing::Le(6000)));
  EXPECT_THAT(at_the_limit, testing::Contains(testing::Gt(5900)));
}

TEST_P(AnyModel, InvalidStaysInvalid) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  DepthImage depth = flat(2.0);
  Cosines cosines = facing(depth);
  const std::array<float, 5> bad_depths{0.0F, -1.0F, nan, infinity, -infinity},
      bad_cosines{0.0F, -1.0F, nan, -infinity, nan};
  for (int row = 0; row < kSize; ++row) {
    depth(row % 7, row) = bad_depths[static_cast<std::size_t>(row) % 5];
    cosines(10 + row % 7, row) = bad_cosines[static_cast<std::size_t>(row) % 5];
    cosines(20 + row % 7, row) = row % 2 == 0 ? infinity : 1.000001F;  // rounding
  }
  const Millimetres result = DepthNoise(config_of(GetParam()), 7).apply(depth, cosines, kFocal_px, 1);
  for (int row = 0; row < kSize; ++row) {
    EXPECT_EQ(result(row % 7, row), 0);
    EXPECT_EQ(result(10 + row % 7, row), 0);
    EXPECT_GT(result(20 + row % 7, row), 0);
    for (int column = 0; column < kSize; ++column)
      ASSERT_THAT(result(column, row), testing::AnyOf(0, testing::AllOf(testing::Gt(1800), testing::Lt(2200))));
  }
}

TEST_P(AnyModel, DependsOnSeedAndTickAlone) {
  const DepthImage depth = flat(2.0);
  const DepthNoise noise(config_of(GetParam()), 7), other(config_of(GetParam()), 8);
  const auto first = noise.apply(depth, facing(depth), kFocal_px, 5).pixels;
  const auto next = noise.apply(depth, facing(depth), kFocal_px, 6).pixels;
  EXPECT_EQ(noise.apply(depth, facing(depth), kFocal_px, 5).pixels, first);
  EXPECT_NE(next, first);
  EXPECT_NE(other.apply(depth, facing(depth), kFocal_px, 5).pixels, first);
}

TEST_P(AnyModel, DrawsEveryPixelAndFrameForItself) {
  const auto first = metres(measure(config_of(GetParam()), flat(2.0), 0, 5));
  const auto next = metres(measure(config_of(GetParam()), flat(2.0), 0, 6));
  const auto other = metres(measure(config_of(GetParam()), flat(2.0), 0, 5, 8));
  const double bound = kSigmas / std::sqrt(static_cast<double>(first.size()));
  EXPECT_LT(std::abs(correlation_of(first, next)), bound);
  EXPECT_LT(std::abs(correlation_of(first, other)), bound);
  for (const std::ptrdiff_t lag : {1, kSize}) {
    EXPECT_LT(std::abs(correlation_of({first.begin() + lag, first.end()}, {first.begin(), first.end() - lag})), bound);
  }
}

TEST(DepthNoise, AcceptsEmptyImagesAndRefusesOtherSizes) {
  const DepthNoise noise({}, 7);
  EXPECT_TRUE(noise.apply({}, {}, kFocal_px, 1).empty());
  EXPECT_THROW(noise.apply(flat(1.0, 4, 3), Cosines(3, 4), kFocal_px, 1), std::invalid_argument);
}

}  // namespace
}  // namespace lapis::simulator
