#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluator/core/statistics.hpp"
#include "evaluator/core/trajectory/association.hpp"

namespace lapis::evaluator {

enum class DeltaUnit {
  kSeconds,  ///< of the estimate's stamps
  kMetres,   ///< of path travelled by the reference
  kFrames,   ///< of matched poses
};

/// Error of the motion over an interval. A is the estimated motion and B the true motion, seen from the body at the
/// start:
enum class MotionError {
  /// A * B^-1: computed by the TUM benchmark's tool evaluate_rpe and used in its published figures.
  kBenchmark,
  /// B^-1 * A: eq. 2 of [Sturm et al., IROS 2012], also used by evo. The translation part has the length |t_A - t_B|.
  kPaper,
};

struct RelativeErrorConfig {
  double delta = 1.0;  ///< length of the intervals, in `unit`; positive (whole for kFrames)
  DeltaUnit unit = DeltaUnit::kSeconds;
  MotionError motion_error = MotionError::kPaper;
};

/// Error over one interval of the estimate.
struct IntervalError {
  time::Time start;
  time::Time end;
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

struct RelativeError {
  std::vector<IntervalError> intervals;
  ErrorStatistics translation_m;
  ErrorStatistics rotation_rad;
};

/// Relative pose error over intervals of fixed length. Each pose starts an interval that ends at the pose nearest to
/// start + delta. In seconds and metres, an interval that would end at the last pose is left out, because there the
/// nearest pose may be far too early (the benchmark's rule). In seconds, the ends are chosen among all poses of the
/// estimate, and an interval counts when both ends are matched. Returns std::nullopt when no interval remains; throws
/// std::invalid_argument for a delta that is not positive.
std::optional<RelativeError> relative_error(const Trajectory& estimate, std::span<const Match> matches,
                                            const RelativeErrorConfig& config);

}  // namespace lapis::evaluator
