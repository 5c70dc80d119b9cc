#include "simulator/core/noise/wheel_odometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "simulator/core/noise/drift.hpp"
#include "statistics.hpp"

namespace lapis::simulator {
namespace {

constexpr std::size_t kRuns = 2000;

OdometryNoiseConfig random_only() {
  OdometryNoiseConfig config;
  config.wheel_sigma = config.base_sigma = 0.0;
  return config;
}
OdometryNoiseConfig systematic_only() {
  OdometryNoiseConfig config;
  config.turn_per_turn = config.turn_per_metre = config.distance_per_metre = config.distance_per_turn = 0.0;
  return config;
}

struct Sums {
  std::vector<double> distances, turns;  // one per run
};

/// Many runs over one path, in equal steps; what the steps of each add up to.
Sums drive(const OdometryNoiseConfig& config, double distance_m, double turn_rad, int steps) {
  Sums sums;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(config, seed);
    double distance = 0, turn = 0;
    for (int i = 0; i < steps; ++i) {
      const OdometryStep step = odometry.step(distance_m / steps, turn_rad / steps);
      distance += step.distance_m;
      turn += step.turn_rad;
    }
    sums.distances.push_back(distance);
    sums.turns.push_back(turn);
  }
  return sums;
}

TEST(WheelOdometry, WithoutErrorsIsTheTruth) {
  OdometryNoiseConfig config;
  config.scale = 0.0;
  WheelOdometry odometry(config, 3);
  const double radius = 0.8;
  for (int i = 1; i <= 500; ++i) {
    odometry.step(0.01, 0.01 / radius);
    const double angle = 0.01 * i / radius;
    ASSERT_NEAR((odometry.position() - radius * Eigen::Vector2d(std::sin(angle), 1 - std::cos(angle))).norm(), 0, 1e-9);
    ASSERT_NEAR(std::remainder(odometry.yaw_rad() - angle, 2 * std::numbers::pi), 0, 1e-9);
    ASSERT_LE(std::abs(odometry.yaw_rad()), std::numbers::pi);
  }
  EXPECT_TRUE(odometry.covariance().isZero());
}

TEST(WheelOdometry, VarianceIsProportionalToMotionWhateverTheStep) {
  const OdometryNoiseConfig c = random_only();
  struct Drive {
    double distance_m, turn_rad;
  };
  for (const Drive motion : {Drive{1, 0}, Drive{4, 0}, Drive{-2, 0}, Drive{0, 2}, Drive{0, -6}, Drive{3, 1.5}}) {
    const double s = std::abs(motion.distance_m), t = std::abs(motion.turn_rad);
    for (const int steps : {1, 10, 150}) {
      const Sums sums = drive(c, motion.distance_m, motion.turn_rad, steps);
      EXPECT_NEAR(variance_of(sums.distances) / (4e-4 * s + 1e-5 * t), 1.0, variance_bound(kRuns)) << s << t << steps;
      EXPECT_NEAR(variance_of(sums.turns) / (4e-4 * t + 1e-4 * s), 1.0, variance_bound(kRuns)) << s << t << steps;
      const double root_n = std::sqrt(static_cast<double>(kRuns));
      EXPECT_NEAR(mean_of(sums.distances), motion.distance_m, kSigmas * std::sqrt(4e-4 * s + 1e-5 * t) / root_n);
      EXPECT_NEAR(mean_of(sums.turns), motion.turn_rad, kSigmas * std::sqrt(4e-4 * t + 1e-4 * s) / root_n);
      EXPECT_LT(std::abs(correlation_of(sums.distances, sums.turns)), kSigmas / root_n);
    }
  }
}

TEST(WheelOdometry, SystematicErrorsAreConstantInARun) {
  std::vector<double> wheels, turns;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(systematic_only(), seed);
    const OdometryStep first = odometry.step(0.5, 0.3), second = odometry.step(-1.5, 2.0);
    ASSERT_NEAR(first.distance_m / 0.5, second.distance_m / -1.5, 1e-12);
    ASSERT_NEAR(first.turn_rad / 0.3, second.turn_rad / 2.0, 1e-12);
    wheels.push_back(std::log(first.distance_m / 0.5));
    turns.push_back(std::log(first.turn_rad / 0.3));
  }
  EXPECT_NEAR(variance_of(wheels) / 1e-4, 1.0, variance_bound(kRuns));
  EXPECT_NEAR(variance_of(turns) / 2e-4, 1.0, variance_bound(kRuns));  // of wheel and base
  EXPECT_NEAR(correlation_of(wheels, turns), std::sqrt(0.5), 0.07);
}

TEST(WheelOdometry, RangesReplaceTheNominalSystematicErrors) {
  OdometryNoiseConfig config = systematic_only();
  config.wheel_range = 0.03;
  config.base_range = 0.02;
  std::vector<double> wheels, bases;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(config, seed);
    const OdometryStep step = odometry.step(1.0, 1.0);
    wheels.push_back(step.distance_m - 1.0);
    bases.push_back(step.distance_m / step.turn_rad - 1.0);
    ASSERT_LE(std::abs(wheels.back()), 0.03);
    ASSERT_LE(std::abs(bases.back()), 0.02 + 1e-12);
  }
  EXPECT_NEAR(variance_of(wheels) / (0.03 * 0.03 / 3.0), 1.0, variance_bound(kRuns));  // of an even distribution
  EXPECT_NEAR(variance_of(bases) / (0.02 * 0.02 / 3.0), 1.0, variance_bound(kRuns));
}

TEST(WheelOdometry, ATurnSlipsByOneShareFromItsBeginToItsEnd) {
  OdometryNoiseConfig config;
  config.scale = 0.0;
  config.turn_slip = 0.1;
  WheelOdometry odometry(config, 5);
  EXPECT_EQ(odometry.step(0.5, 0.0).turn_rad, 0.0);
  std::vector<double> slips;
  for (int turn = 0; turn < 200; ++turn) {
    const double way = turn % 4 < 2 ? 0.01 : -0.01;  // at times back, at times on after a stretch
    const double first = odometry.step(0.0, way).turn_rad / way;
    for (int i = 0; i < 5; ++i) ASSERT_NEAR(odometry.step(0.01, 2.0 * way).turn_rad / (2.0 * way), first, 1e-12);
    slips.push_back(first - 1.0);
    odometry.step(0.2, 0.0);
  }
  EXPECT_GE(*std::min_element(slips.begin(), slips.end()), 0.0);
  EXPECT_LE(*std::max_element(slips.begin(), slips.end()), 0.1);
  EXPECT_NEAR(mean_of(slips), 0.05, kSigmas * 0.1 / std::sqrt(12.0 * 200));
}

/// Normalised squared error of the pose after a winding path of 8 m.
double normalised_error(const OdometryNoiseConfig& config, std::uint64_t seed) {
  OdometryNoiseConfig perfect;
  perfect.scale = 0.0;
  WheelOdometry odometry(config, seed), truth(perfect, seed);
  for (int i = 0; i < 400; ++i) {
    const double turn = 0.02 * std::sin(0.02 * i) + 0.004;
    odometry.step(0.02, turn);
    truth.step(0.02, turn);
  }
  Eigen::Vector3d error;
  error << odometry.position() - truth.position(),
      std::remainder(odometry.yaw_rad() - truth.yaw_rad(), 2 * std::numbers::pi);
  return error.dot(odometry.covariance().inverse() * error);
}

TEST(WheelOdometry, CovarianceIsWhatErrorsReallyAre) {
  for (const OdometryNoiseConfig& config : {OdometryNoiseConfig(), random_only()}) {
    std::vector<double> errors;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) errors.push_back(normalised_error(config, seed));
    // Chi-squared with 3 degrees of freedom has mean 3 and variance 6; the covariance is right to first order.
    EXPECT_NEAR(mean_of(errors), 3.0, kSigmas * std::sqrt(6.0 / 1000) + 0.1);
  }
}

TEST(WheelOdometry, CovarianceOfOneLongStepIsThatOfItsSamples) {
  std::vector<double> x, y, yaw;
  Eigen::Matrix3d reported = Eigen::Matrix3d::Zero();
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(random_only(), seed);
    odometry.step(0.8, 0.4);
    x.push_back(odometry.position().x());
    y.push_back(odometry.position().y());
    yaw.push_back(odometry.yaw_rad());
    reported += odometry.covariance() / static_cast<double>(kRuns);
  }
  const std::array<const std::vector<double>*, 3> samples{&x, &y, &yaw};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double sampled =
          covariance_of(*samples[static_cast<std::size_t>(i)], *samples[static_cast<std::size_t>(j)]);
      const double scale = std::sqrt(reported(i, i) * reported(j, j));
      EXPECT_NEAR(sampled / scale, reported(i, j) / scale, variance_bound(kRuns)) << i << ", " << j;
    }
  }
}

TEST(WheelOdometry, CovarianceGrows) {
  WheelOdometry odometry({}, 3);
  double last = 0.0;
  for (int i = 0; i < 100; ++i) {
    odometry.step(0.02, 0.01);
    ASSERT_GT(odometry.covariance().trace(), last);
    ASSERT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(odometry.covariance()).eigenvalues().minCoeff(), -1e-12);
    last = odometry.covariance().trace();
  }
}

TEST(WheelOdometry, ScaleMultipliesStandardDeviations) {
  OdometryNoiseConfig config;
  const Sums nominal = drive(config, 2, 1, 5);
  config.scale = 3.0;
  const Sums scaled = drive(config, 2, 1, 5);
  EXPECT_NEAR(variance_of(scaled.distances) / variance_of(nominal.distances), 9.0, 0.01);  // the same draws
  EXPECT_NEAR(variance_of(scaled.turns) / variance_of(nominal.turns), 9.0, 0.1);
}

TEST(WheelOdometry, StandingStillDoesNotDrift) {
  WheelOdometry odometry({}, 3);
  for (int i = 0; i < 1000; ++i) odometry.step(0, 0);
  EXPECT_TRUE(odometry.position().isZero());
  EXPECT_EQ(odometry.yaw_rad(), 0.0);
  EXPECT_TRUE(odometry.covariance().isZero());
}

TEST(WheelOdometry, NoiseDependsOnSeedAndStepNumber) {
  WheelOdometry a(random_only(), 3), b(random_only(), 3), c(random_only(), 4);
  a.step(0.02, 0.01);
  b.step(0.05, -0.2);  // another path, the same number of steps
  const OdometryStep from_a = a.step(0.02, 0.01), from_b = b.step(0.02, 0.01);
  c.step(0.02, 0.01);
  EXPECT_EQ(from_a.distance_m, from_b.distance_m);
  EXPECT_EQ(from_a.turn_rad, from_b.turn_rad);
  EXPECT_NE(c.step(0.02, 0.01).turn_rad, from_a.turn_rad);
}

TEST(DriftPreset, NominalChangesNothingAndHardIsHarderInEveryRespect) {
  const DriftScales nominal = drift_scales(DriftPreset::kNominal), hard = drift_scales(DriftPreset::kHard);
  EXPECT_EQ(nominal.texture, 1.0);
  EXPECT_EQ(nominal.dropout, 0.0);
  EXPECT_EQ(nominal.blur, 0.0);
  EXPECT_EQ(nominal.depth, 1.0);
  EXPECT_EQ(nominal.odometry, 1.0);
  EXPECT_LT(hard.texture, nominal.texture);
  EXPECT_GT(hard.dropout, nominal.dropout);
  EXPECT_GT(hard.blur, nominal.blur);
  EXPECT_GT(hard.depth, nominal.depth);
  EXPECT_GT(hard.odometry, nominal.odometry);
}

}  // namespace
}  // namespace lapis::simulator
