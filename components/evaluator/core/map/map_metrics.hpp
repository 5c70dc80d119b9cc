#pragma once

#include <optional>
#include <vector>

#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// Agreement of occupied voxels when a partner's centre may be up to `tolerance_m` away (0 = the same voxel).
struct Overlap {
  double tolerance_m = 0.0;
  std::optional<double> precision;  ///< share of the estimate with a partner; none for an empty estimate
  std::optional<double> recall;     ///< share of the reference with a partner; none for an empty reference
  std::optional<double> f1;         ///< harmonic mean; 0 when exactly one map is empty, none when both are empty
};

/// Distances between the centres of occupied voxels, without regard to labels and without registration. Figures that
/// need a voxel in both maps are missing when one of them is empty.
struct MapError {
  std::optional<double> accuracy_mean_m;      ///< from each voxel of the estimate to the nearest of the reference
  std::optional<double> accuracy_p95_m;       ///< 95th percentile of the same distances
  std::optional<double> completeness_mean_m;  ///< from each voxel of the reference to the nearest of the estimate
  std::vector<Overlap> overlaps;              ///< for tolerances of 0, 0.25 and 0.5 m
};

/// Throws std::invalid_argument when the resolutions differ.
MapError map_error(const LabelledVoxels& reference, const LabelledVoxels& estimate);

}  // namespace lapis::evaluator
