#include "evaluator/core/map_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "evaluator/core/nearest_voxel.hpp"
#include "evaluator/core/statistics.hpp"

namespace lapis::evaluator {
namespace {

constexpr int kMaxTolerance = 2;

std::vector<VoxelIndex> indices(const LabelledVoxels& map) {
  std::vector<VoxelIndex> result;
  result.reserve(map.voxels.size());
  for (const LabelledVoxel& voxel : map.voxels) result.push_back(voxel.index);
  return result;
}

// Squared distances [voxels^2] from each voxel of `from` to the nearest of `to`; empty when `to` is.
std::vector<std::int64_t> squared_distances(const LabelledVoxels& from, const LabelledVoxels& to) {
  std::vector<std::int64_t> result;
  if (to.voxels.empty()) return result;
  const NearestVoxel nearest(indices(to));
  result.reserve(from.voxels.size());
  for (const LabelledVoxel& voxel : from.voxels) result.push_back(nearest.squared_distance(voxel.index));
  return result;
}

std::vector<double> to_metres(const std::vector<std::int64_t>& squared, double resolution_m) {
  std::vector<double> result;
  result.reserve(squared.size());
  for (const std::int64_t d : squared) result.push_back(std::sqrt(static_cast<double>(d)) * resolution_m);
  return result;
}

std::optional<double> mean(const std::vector<double>& values) {
  const auto statistics = error_statistics(values);
  return statistics ? std::optional(statistics->mean) : std::nullopt;
}

// Share of `count` voxels whose partner is near enough; without any voxel there is nothing to share.
std::optional<double> share_within(const std::vector<std::int64_t>& squared, std::size_t count, int tolerance) {
  if (count == 0) return std::nullopt;
  const auto hits = std::count_if(squared.begin(), squared.end(),
                                  [tolerance](std::int64_t d) { return d <= std::int64_t{tolerance} * tolerance; });
  return static_cast<double>(hits) / static_cast<double>(count);
}

std::optional<double> f1_score(std::optional<double> precision, std::optional<double> recall) {
  if (!precision && !recall) return std::nullopt;
  const double p = precision.value_or(0.0);
  const double r = recall.value_or(0.0);
  return p + r > 0.0 ? 2.0 * p * r / (p + r) : 0.0;
}

}  // namespace

MapError map_error(const LabelledVoxels& reference, const LabelledVoxels& estimate) {
  require_same_grid(reference, estimate);
  const auto to_reference = squared_distances(estimate, reference);
  const auto to_estimate = squared_distances(reference, estimate);
  const auto accuracy_m = to_metres(to_reference, reference.resolution_m);
  MapError result;
  result.accuracy_mean_m = mean(accuracy_m);
  result.accuracy_p95_m = quantile(accuracy_m, 0.95);
  result.completeness_mean_m = mean(to_metres(to_estimate, reference.resolution_m));
  for (int tolerance = 0; tolerance <= kMaxTolerance; ++tolerance) {
    const auto precision = share_within(to_reference, estimate.voxels.size(), tolerance);
    const auto recall = share_within(to_estimate, reference.voxels.size(), tolerance);
    result.overlaps.push_back({tolerance, precision, recall, f1_score(precision, recall)});
  }
  return result;
}

}  // namespace lapis::evaluator
