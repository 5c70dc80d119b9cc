#include "simulator/core/noise/imu_noise.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "statistics.hpp"

namespace lapis::simulator {
namespace {

const Eigen::Vector3d kTurnRate(0.1, -0.2, 0.7), kAcceleration(0.3, -0.4, 9.81);

struct Signals {
  std::vector<double> turn_rate, acceleration;  // errors along one axis
};

Signals errors_of(const ImuNoiseConfig& config, std::uint64_t seed, int axis, int readings, double period_s) {
  ImuNoise imu(config, seed);
  Signals signals;
  for (int i = 0; i < readings; ++i) {
    const ImuReading reading = imu.read(kTurnRate, kAcceleration, period_s);
    signals.turn_rate.push_back(reading.turn_rate_rad_s[axis] - kTurnRate[axis]);
    signals.acceleration.push_back(reading.acceleration_m_s2[axis] - kAcceleration[axis]);
  }
  return signals;
}

/// Half of the mean squared difference of neighbouring means over `cluster` readings.
double allan_variance(const std::vector<double>& signal, std::size_t cluster) {
  std::vector<double> means;
  for (std::size_t i = 0; i + cluster <= signal.size(); i += cluster)
    means.push_back(mean_of(
        {signal.begin() + static_cast<std::ptrdiff_t>(i), signal.begin() + static_cast<std::ptrdiff_t>(i + cluster)}));
  double sum = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) sum += 0.5 * (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  return sum / static_cast<double>(means.size() - 1);
}

TEST(ImuNoise, WhiteNoiseIsDensityOverRootOfPeriod) {
  ImuNoiseConfig config;
  config.gyro_walk = config.acceleration_walk = 0.0;
  for (const double period_s : {0.005, 0.01, 0.1}) {
    for (int axis = 0; axis < 3; ++axis) {
      const Signals signals = errors_of(config, 3, axis, 20000, period_s);
      const double turn_rate = std::pow(1.6968e-4, 2) / period_s, acceleration = std::pow(2.0e-3, 2) / period_s;
      EXPECT_NEAR(variance_of(signals.turn_rate) / turn_rate, 1.0, variance_bound(20000));
      EXPECT_NEAR(variance_of(signals.acceleration) / acceleration, 1.0, variance_bound(20000));
      EXPECT_NEAR(mean_of(signals.turn_rate), 0.0, kSigmas * std::sqrt(turn_rate / 20000));
      EXPECT_NEAR(mean_of(signals.acceleration), 0.0, kSigmas * std::sqrt(acceleration / 20000));
      const ImuReading reading = ImuNoise(config, 3).read(kTurnRate, kAcceleration, period_s);
      EXPECT_NEAR(reading.turn_rate_variance / turn_rate, 1.0, 1e-12);
      EXPECT_NEAR(reading.acceleration_variance / acceleration, 1.0, 1e-12);
    }
  }
}

TEST(ImuNoise, BiasWalksWithTheRootOfTimeWhateverThePeriod) {
  ImuNoiseConfig config;
  config.gyro_density = config.acceleration_density = 0.0;
  for (const int readings : {4, 50, 200}) {
    const double duration_s = 2.0;
    std::vector<double> turn_rates, accelerations;
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
      const Signals signals = errors_of(config, seed, 1, readings, duration_s / readings);
      turn_rates.push_back(signals.turn_rate.back());
      accelerations.push_back(signals.acceleration.back());
    }
    EXPECT_NEAR(variance_of(turn_rates) / (1.9393e-5 * 1.9393e-5 * duration_s), 1.0, variance_bound(1500));
    EXPECT_NEAR(variance_of(accelerations) / (3.0e-3 * 3.0e-3 * duration_s), 1.0, variance_bound(1500));
    EXPECT_LT(std::abs(correlation_of(turn_rates, accelerations)), kSigmas / std::sqrt(1500.0));
  }
}

TEST(ImuNoise, AllanVarianceShowsBoth) {
  // IEEE Std 952: N^2 / tau + K^2 tau / 3, for clusters of many readings.
  const double period_s = 0.01;
  for (const std::size_t cluster : {20U, 100U, 1000U}) {
    const double tau_s = period_s * static_cast<double>(cluster);
    double variance = 0.0;
    const std::uint64_t runs = 20;
    for (std::uint64_t seed = 0; seed < runs; ++seed)
      variance += allan_variance(errors_of({}, seed, 2, 20000, period_s).acceleration, cluster) / runs;
    const double expected = 2.0e-3 * 2.0e-3 / tau_s + 3.0e-3 * 3.0e-3 * tau_s / 3;
    const std::size_t differences = runs * (20000 / cluster - 1);
    EXPECT_NEAR(variance / expected, 1.0, 1.3 * variance_bound(differences)) << tau_s;  // neighbours share a mean
  }
}

TEST(ImuNoise, AxesAreIndependent) {
  const Signals x = errors_of({}, 3, 0, 10000, 0.005), y = errors_of({}, 3, 1, 10000, 0.005);
  EXPECT_LT(std::abs(correlation_of(x.turn_rate, y.turn_rate)), 0.06);  // 5 sigma, and a bit for the walk
  EXPECT_LT(std::abs(correlation_of(x.turn_rate, x.acceleration)), 0.06);
}

TEST(ImuNoise, WalkAndWhiteNoiseAreIndependent) {
  constexpr int kReadings = 10000;
  const Signals white = errors_of({1, 0, 1, 0}, 3, 0, kReadings, 1.0);
  Signals walk = errors_of({0, 1, 0, 1}, 3, 0, kReadings, 1.0);
  std::adjacent_difference(walk.turn_rate.begin(), walk.turn_rate.end(), walk.turn_rate.begin());
  std::adjacent_difference(walk.acceleration.begin(), walk.acceleration.end(), walk.acceleration.begin());
  for (const auto* step : {&walk.turn_rate, &walk.acceleration})
    for (const auto* noise : {&white.turn_rate, &white.acceleration})
      EXPECT_LT(std::abs(correlation_of(*step, *noise)), kSigmas / std::sqrt(kReadings));
}

TEST(ImuNoise, DependsOnSeedAndNumberAlone) {
  EXPECT_EQ(errors_of({}, 3, 0, 50, 0.005).acceleration, errors_of({}, 3, 0, 50, 0.005).acceleration);
  EXPECT_NE(errors_of({}, 3, 0, 50, 0.005).acceleration, errors_of({}, 4, 0, 50, 0.005).acceleration);
}

TEST(ImuNoise, WithoutDensitiesIsTheIdentity) {
  ImuNoise imu({0, 0, 0, 0}, 3);
  for (int i = 0; i < 10; ++i) {
    const ImuReading reading = imu.read(kTurnRate, kAcceleration, 0.005);
    EXPECT_EQ(reading.turn_rate_rad_s, kTurnRate);
    EXPECT_EQ(reading.acceleration_m_s2, kAcceleration);
  }
}

}  // namespace
}  // namespace lapis::simulator
