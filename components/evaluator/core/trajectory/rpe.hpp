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

/// With A the estimate's motion over the interval and B the true one, seen from the body at its start:
enum class MotionError {
  /// A * B^-1: what the TUM benchmark's evaluate_rpe tool computes; its published figures are these.
  kBenchmark,
  /// B^-1 * A: eq. 2 of [Sturm et al., IROS 2012], and evo's. The translation part has the length |t_A - t_B|.
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
/// start + delta. Over seconds and metres an interval that would end at the last pose is left out, because there the
/// nearest pose may be far too early (the benchmark's rule). Over seconds the ends are chosen among all poses of the
/// estimate, and an interval counts when both ends are matched. std::nullopt when no interval remains; throws
/// std::invalid_argument for a delta that is not positive.
std::optional<RelativeError> relative_error(const Trajectory& estimate, std::span<const Match> matches,
                                            const RelativeErrorConfig& config);

}  // namespace lapis::evaluator
