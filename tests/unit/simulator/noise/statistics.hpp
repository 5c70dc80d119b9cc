#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace lapis::simulator {

/// Bounds of tests are this many standard errors wide. Seeds are fixed: a test passes always or never.
inline constexpr double kSigmas = 5.0;

inline double mean_of(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v;
  return sum / static_cast<double>(x.size());
}

/// Sum of products of deviations over n.
inline double covariance_of(const std::vector<double>& x, const std::vector<double>& y) {
  const double mx = mean_of(x), my = mean_of(y);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mx) * (y[i] - my);
  return sum / static_cast<double>(x.size());
}

inline double variance_of(const std::vector<double>& x) { return covariance_of(x, x); }

inline double correlation_of(const std::vector<double>& x, const std::vector<double>& y) {
  return covariance_of(x, y) / std::sqrt(variance_of(x) * variance_of(y));
}

/// Bound on the relative error of a sample variance of n normal numbers.
inline double variance_bound(std::size_t n) { return kSigmas * std::sqrt(2.0 / static_cast<double>(n)); }

/// Bound on the error of a share among n draws; allows for steps of 1/4096 in tables.
inline double share_bound(double share, std::size_t n) {
  return kSigmas * std::sqrt(share * (1 - share) / static_cast<double>(n)) + 1.0 / 4096.0;
}

inline double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace lapis::simulator
