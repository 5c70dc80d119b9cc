#pragma once

#include <optional>
#include <vector>

#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

struct Coverage {
  double explored_volume_m3 = 0.0;  ///< free plus occupied
  double free_volume_m3 = 0.0;
  double occupied_volume_m3 = 0.0;
  /// Share of the reference's known voxels that the map knows, whether as free or as occupied; none without a reference
  /// or with an empty one.
  std::optional<double> explored_share;
};

Coverage coverage(const KnownSpace& map);
/// Throws std::invalid_argument when the resolutions differ.
Coverage coverage(const KnownSpace& reference, const KnownSpace& map);

/// The known voxels of a map at several times, stored as changes, so that they can be compared with a reference when
/// the run is over.
class KnownHistory {
 public:
  void add(const KnownSpace& map);
  /// For each map added, its coverage().explored_share; empty for an empty reference. The grids must coincide.
  std::vector<double> shares(const KnownSpace& reference) const;

 private:
  struct Change {
    std::vector<VoxelIndex> added, removed;
  };
  std::vector<VoxelIndex> known_;  ///< known voxels of the newest map, sorted
  std::vector<Change> changes_;
};

}  // namespace lapis::evaluator
