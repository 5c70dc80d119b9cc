#pragma once

#include <cmath>
#include <cstdint>

#include "simulator/core/looks/canvas.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {

/// Draws the numbers of one random stream in turn, for things that are built step by step. Write two draws of one
/// expression in braces: only in braces does every compiler evaluate them from left to right.
class Dice {
 public:
  explicit Dice(const Random& random) : random_(random) {}

  double operator()(double low, double high) { return random_.uniform(next_++, low, high); }
  /// Whole number from low to high, both included.
  int whole(int low, int high) { return low + static_cast<int>(std::floor((*this)(0.0, high - low + 1.0))); }
  bool chance(double probability) { return (*this)(0.0, 1.0) < probability; }
  /// A random colour of any hue.
  Paint color(double min_saturation = 0.25, double max_saturation = 0.8) {
    return hsv({(*this)(0.0, 1.0), (*this)(min_saturation, max_saturation), (*this)(0.35, 0.95)});
  }

 private:
  Random random_;
  std::uint64_t next_ = 0;
};

}  // namespace lapis::simulator
