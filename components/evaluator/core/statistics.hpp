#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace lapis::evaluator {

/// Figures of a set of errors, in their unit.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< mean of the two middle values of an even count
  double std = 0.0;     ///< around the mean, divided by the count
  double min = 0.0;
  double max = 0.0;
};

/// std::nullopt for an empty set: nothing was measured.
std::optional<ErrorStatistics> error_statistics(std::vector<double> errors);

/// Quantile q in [0, 1] with linear interpolation between the sorted values (numpy's default); std::nullopt for an
/// empty set.
std::optional<double> quantile(std::vector<double> values, double q);

}  // namespace lapis::evaluator
