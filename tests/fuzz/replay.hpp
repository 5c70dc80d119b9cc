#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace lapis::fuzz {

using Fuzzer = int (*)(const std::uint8_t* data, std::size_t size);

/// Gives a fuzzer its seeds, their beginnings, and copies with some bytes changed.
inline void replay(Fuzzer fuzzer, const std::vector<std::vector<std::uint8_t>>& seeds) {
  constexpr std::size_t kBeginnings = 16;
  constexpr int kSpoilt = 300;
  std::mt19937 random(1);
  for (const auto& input : seeds) {
    for (std::size_t i = 0; i <= kBeginnings; ++i) EXPECT_EQ(fuzzer(input.data(), input.size() * i / kBeginnings), 0);
    for (int i = 0; i < kSpoilt; ++i) {
      auto copy = input;
      for (std::size_t k = 0; k < 1 + random() % 4; ++k)
        copy[random() % copy.size()] = static_cast<std::uint8_t>(random());
      EXPECT_EQ(fuzzer(copy.data(), copy.size()), 0);
    }
  }
}

}  // namespace lapis::fuzz
