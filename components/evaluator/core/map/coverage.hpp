#pragma once

#include <optional>
#include <vector>

#include "evaluator/core/map/voxels.hpp"

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

/// What a map knew at several times, kept as changes, so that it can be compared when the run is over.
class KnownHistory {
 public:
  void add(const KnownSpace& map);
  /// For each map added, its coverage().explored_share; empty for an empty reference. The grids must coincide.
  std::vector<double> shares(const KnownSpace& reference) const;

 private:
  struct Change {
    std::vector<VoxelIndex> added, removed;
  };
  std::vector<VoxelIndex> known_;  ///< by the newest map, sorted
  std::vector<Change> changes_;
};

}  // namespace lapis::evaluator
