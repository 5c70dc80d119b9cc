#pragma once

#include <span>
#include <vector>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"
#include "slam/core/tracking/pose_refiner.hpp"

namespace lapis::slam {

/// How many matches agree with a pose, and how many would with a wrong one. A match agrees when its pixel is at most
/// TrackerConfig::ransac_error_px away from where the pose has it. Only confirmed points count, where there are
/// enough of them (has_witnesses): what moves has others.
struct Support {
  int agree = 0;
  int of = 0;              ///< number of points that count
  int rivals = 0;          ///< of the others, most that agree with one pose; not counted where all were too few
  double by_chance = 0.0;  ///< expected number that would agree with a wrong pose
};

/// Support of T_reference_camera. `window_px2`: area in which the pixel of a wrong match can lie [px^2].
Support find_support(const TrackerConfig& config, const geometry::PinholeCamera& camera,
                     std::span<const PointConstraint> points, const geometry::Pose& T_reference_camera,
                     double window_px2);

/// Whether more matches agree than with another pose or by chance, by TrackerConfig::rival_sigmas of their sum.
bool is_significant(const TrackerConfig& config, const Support& support);

/// The points that count: the confirmed ones where there are enough, else all.
std::vector<PointConstraint> witnesses(const TrackerConfig& config, std::span<const PointConstraint> points);

}  // namespace lapis::slam
