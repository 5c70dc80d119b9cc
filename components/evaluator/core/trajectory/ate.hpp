#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluator/core/statistics.hpp"
#include "evaluator/core/trajectory/association.hpp"

namespace lapis::evaluator {

enum class Alignment {
  kNone,    ///< both trajectories share a frame
  kOrigin,  ///< aligned so that the first matched poses are equal
  kSe3,     ///< least squares over all positions, without scale
};

/// Errors of one matched pose after alignment.
struct PoseError {
  time::Time stamp;
  double position_m = 0.0;
  /// Rotation about the vertical (z) axis of the reference frame between the two attitudes, in (-pi, pi]. It is the
  /// twist part of R_estimate * R_reference', so that it does not depend on the axes of the moving frame.
  double heading_rad = 0.0;
};

struct AbsoluteError {
  geometry::Pose T_reference_estimate = geometry::Pose::Identity();  ///< the alignment found
  std::vector<PoseError> poses;
  ErrorStatistics position_m;
  ErrorStatistics heading_rad;  ///< of the absolute values
};

/// Rigid transform T_a_b that minimises the sum of |p_a - T_a_b * p_b|^2 over corresponding points (eq. 40-43 in
/// [Umeyama, PAMI 1991] with scale 1). The rotation is always proper; when the points do not determine it (all on a
/// line), it is one of the best. Throws std::invalid_argument when the counts differ or are zero.
geometry::Pose align_points(std::span<const Eigen::Vector3d> p_a, std::span<const Eigen::Vector3d> p_b);

/// Absolute trajectory error of matched poses; std::nullopt without a match.
std::optional<AbsoluteError> absolute_error(std::span<const Match> matches, Alignment alignment);

}  // namespace lapis::evaluator
