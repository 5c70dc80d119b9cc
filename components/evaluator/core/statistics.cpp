#include "evaluator/core/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::evaluator {
namespace {

double sorted_quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double share = position - static_cast<double>(below);
  return sorted[below] + share * (sorted[above] - sorted[below]);
}

}  // namespace

std::optional<ErrorStatistics> error_statistics(std::vector<double> errors) {
  if (errors.empty()) return std::nullopt;
  std::sort(errors.begin(), errors.end());
  const auto count = static_cast<double>(errors.size());
  ErrorStatistics result;
  result.count = errors.size();
  for (const double error : errors) {
    result.mean += error / count;
    result.rmse += error * error / count;
  }
  result.rmse = std::sqrt(result.rmse);
  for (const double error : errors) result.std += (error - result.mean) * (error - result.mean) / count;
  result.std = std::sqrt(result.std);
  result.median = sorted_quantile(errors, 0.5);
  result.min = errors.front();
  result.max = errors.back();
  return result;
}

std::optional<double> quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  return sorted_quantile(values, std::clamp(q, 0.0, 1.0));
}

}  // namespace lapis::evaluator
