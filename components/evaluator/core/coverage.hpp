#pragma once

#include <optional>
#include <vector>

#include "evaluator/core/voxels.hpp"

namespace lapis::evaluator {

struct Coverage {
  double explored_volume_m3 = 0.0;  ///< free and occupied
  double free_volume_m3 = 0.0;
  double occupied_volume_m3 = 0.0;
  /// Share of the reference's known voxels that the map knows, whatever it holds them for; none without a reference
  /// or with an empty one.
  std::optional<double> explored_share;
};

Coverage coverage(const KnownSpace& map);
/// Throws std::invalid_argument when the resolutions differ.
Coverage coverage(const KnownSpace& reference, const KnownSpace& map);

/// Share of the explorable volume that was known at a time of the run.
struct ShareAt {
  double time_s = 0.0;
  double share = 0.0;
};

/// When the share first reached `share`; none when it never did. The rows are in the order of time.
std::optional<double> time_to_reach(const std::vector<ShareAt>& rows, double share);

}  // namespace lapis::evaluator
