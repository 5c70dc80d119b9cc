#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace lapis::simulator {

/// Sensors and other consumers of random numbers. Each has streams of its own, so that switching one off, changing the
/// number of threads or skipping a frame never shifts the numbers of another.
enum class RandomStream : std::uint64_t {
  kStartPose = 1,
  kFurniture,
  kPictures,
  kTexture,
  kDepth,
  kColor,
  kLabelBoundary,
  kLabelConfusion,
  kLabelFlip,
  kOdometrySystematic,
  kOdometry,
  kImu,
  kTruth,
  kBuilding,
  kWorld,
  kDrive
};

/// Counter-based random numbers: a pure function of (seed, stream, counter, index). The mixing function is that of
/// SplitMix64 [Steele, Lea, Flood, OOPSLA 2014], applied once per key.
class Random {
 public:
  /// @param counter usually the tick; @param seed of the run
  Random(std::uint64_t seed, RandomStream stream, std::uint64_t counter = 0)
      : key_(mix(mix(mix(seed) + static_cast<std::uint64_t>(stream)) + counter)) {}

  std::uint64_t bits(std::uint64_t index) const { return mix(key_ + index * kGolden); }
  /// A number in [0, 1), which is a multiple of 2^-53.
  double uniform(std::uint64_t index) const { return static_cast<double>(bits(index) >> 11U) * 0x1.0p-53; }
  double uniform(std::uint64_t index, double low, double high) const { return low + (high - low) * uniform(index); }
  /// Standard normal by Box and Muller; uses the indices 2 * index and 2 * index + 1 of the stream.
  double normal(std::uint64_t index) const {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(2 * index)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(2 * index + 1));
  }

 private:
  static constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;
  static std::uint64_t mix(std::uint64_t x) {
    x += kGolden;
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31U);
  }
  std::uint64_t key_;
};

}  // namespace lapis::simulator
