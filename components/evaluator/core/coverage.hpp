#pragma once

#include <optional>

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

}  // namespace lapis::evaluator
