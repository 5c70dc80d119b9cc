#include "simulator/core/noise/normal_table.hpp"

#include <cmath>
#include <numbers>

namespace lapis::simulator {
namespace {

/// x with Phi(x) = p, for p in [0.5, 1), by Newton's method; from 0 it never overshoots, because Phi is concave there.
double normal_quantile(double p) {
  double x = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double excess = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    x -= excess / density;
  }
  return x;
}

}  // namespace

const NormalTable& NormalTable::get() {
  static const NormalTable table;
  return table;
}

NormalTable::NormalTable() {
  std::array<double, kSize / 2> upper;
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < upper.size(); ++i) {
    upper[i] = normal_quantile(0.5 + (static_cast<double>(i) + 0.5) / static_cast<double>(kSize));
    sum_of_squares += 2.0 * upper[i] * upper[i];
  }
  const double scale = std::sqrt(static_cast<double>(kSize) / sum_of_squares);
  for (std::size_t i = 0; i < upper.size(); ++i) {
    values_[kSize / 2 + i] = static_cast<float>(scale * upper[i]);
    values_[kSize / 2 - 1 - i] = -values_[kSize / 2 + i];
  }
}

}  // namespace lapis::simulator
