#include "evaluator/core/map/map_metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "evaluator/core/map/nearest_voxel.hpp"
#include "evaluator/core/statistics.hpp"

namespace lapis::evaluator {
namespace {

constexpr std::array kTolerances_m = {0.0, 0.25, 0.5};
constexpr double kRounding_m = 1e-9;

std::vector<VoxelIndex> indices(const LabelledVoxels& map) {
  std::vector<VoxelIndex> result;
  result.reserve(map.voxels.size());
  for (const LabelledVoxel& voxel : map.voxels) result.push_back(voxel.index);
  return result;
}

// Distances from the centre of each voxel of `from` to the nearest centre of `to` [m]; empty when `to` is empty.
std::vector<double> distances_m(const LabelledVoxels& from, const LabelledVoxels& to) {
  std::vector<double> result;
  if (to.voxels.empty()) return result;
  const NearestVoxel nearest(indices(to));
  result.reserve(from.voxels.size());
  for (const LabelledVoxel& voxel : from.voxels) {
    result.push_back(std::sqrt(static_cast<double>(nearest.squared_distance(voxel.index))) * from.resolution_m);
  }
  return result;
}

std::optional<double> mean(const std::vector<double>& values) {
  const auto statistics = error_statistics(values);
  return statistics ? std::optional(statistics->mean) : std::nullopt;
}

// Share of `count` voxels whose partner is near enough; none without any voxel.
std::optional<double> share_within(const std::vector<double>& distances_m, std::size_t count, double tolerance_m) {
  if (count == 0) return std::nullopt;
  const auto hits = std::count_if(distances_m.begin(), distances_m.end(),
                                  [tolerance_m](double d) { return d <= tolerance_m + kRounding_m; });
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
  const auto accuracy_m = distances_m(estimate, reference);
  const auto completeness_m = distances_m(reference, estimate);
  MapError result;
  result.accuracy_mean_m = mean(accuracy_m);
  result.accuracy_p95_m = quantile(accuracy_m, 0.95);
  result.completeness_mean_m = mean(completeness_m);
  for (const double tolerance_m : kTolerances_m) {
    const auto precision = share_within(accuracy_m, estimate.voxels.size(), tolerance_m);
    const auto recall = share_within(completeness_m, reference.voxels.size(), tolerance_m);
    result.overlaps.push_back({tolerance_m, precision, recall, f1_score(precision, recall)});
  }
  return result;
}

}  // namespace lapis::evaluator
