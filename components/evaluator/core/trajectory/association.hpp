#pragma once

#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace lapis::evaluator {

using trajectory::StampedPose;
using trajectory::Trajectory;

enum class AssociationRule {
  kNearest,      ///< one-to-one, smallest time difference first (the TUM RGB-D benchmark's rule)
  kInterpolate,  ///< reference interpolated at the estimate's stamp (linear and slerp): used for runs
};

struct AssociationConfig {
  AssociationRule rule = AssociationRule::kInterpolate;
  /// The nearest reference pose must be closer in time than this; 1 ms to 1 s is sensible.
  time::Duration max_difference = time::Duration::from_seconds(0.02);
};

/// A pose of the estimate and its true pose.
struct Match {
  std::size_t estimate_index = 0;  ///< index into the estimate's trajectory
  time::Time stamp;                ///< stamp of the estimate
  geometry::Pose T_world_estimate = geometry::Pose::Identity();
  geometry::Pose T_world_reference = geometry::Pose::Identity();
};

/// Matches in the order of the estimate's stamps; poses without a partner are left out. There is no extrapolation: with
/// kInterpolate, a stamp before the first or after the last reference pose has no partner.
std::vector<Match> associate(const Trajectory& reference, const Trajectory& estimate, const AssociationConfig& config);

}  // namespace lapis::evaluator
