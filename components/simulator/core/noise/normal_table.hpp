#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lapis::simulator {

/// Standard normal numbers for images, where logarithms take too long: 4096 equally probable values, which are the
/// quantiles of the normal distribution, scaled to a variance of exactly 1. Tails end at 3.67 standard deviations.
class NormalTable {
 public:
  static constexpr unsigned kBits = 12;
  static constexpr std::size_t kSize = std::size_t{1} << kBits;

  /// The only table, which is computed at the first call.
  static const NormalTable& get();

  /// Value for the `slot`-th group of 12 bits; slots 0 to 4 of one number are independent.
  float operator()(std::uint64_t bits, unsigned slot) const { return values_[(bits >> (kBits * slot)) % kSize]; }
  const std::array<float, kSize>& values() const { return values_; }

 private:
  NormalTable();
  std::array<float, kSize> values_;
};

}  // namespace lapis::simulator
