#pragma once

#include <cstdint>
#include <random>

namespace lapis::slam::benchmark {

/// Numbers that a seed draws, one after the other.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(generator_() >> 11U) * 0x1p-53;
  }
  double sign() { return between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0; }

 private:
  std::mt19937_64 generator_;
};

}  // namespace lapis::slam::benchmark
