#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace lapis::evaluator {

/// Statistics of a set of errors, in the unit of the errors.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< mean of the two middle values of an even count
  double std = 0.0;     ///< standard deviation around the mean, with division by the count
  double min = 0.0;
  double max = 0.0;
};

/// std::nullopt for an empty set: nothing was measured.
std::optional<ErrorStatistics> error_statistics(std::vector<double> errors);

/// Quantile q in [0, 1] with linear interpolation between the sorted values (numpy's default); std::nullopt for an
/// empty set.
std::optional<double> quantile(std::vector<double> values, double q);

}  // namespace lapis::evaluator
