#pragma once

#include "common/geometry/se3.hpp"

namespace lapis::slam {

inline double squared(double x) { return x * x; }

/// Covariance of A * B for independent right perturbations.
geometry::Matrix6d compound_covariance(const geometry::Matrix6d& covariance_a, const geometry::Pose& B,
                                       const geometry::Matrix6d& covariance_b);

/// Largest standard deviation along any direction of the position (`first` = 0) [m] or the rotation (3) [rad].
double largest_sigma(const geometry::Matrix6d& covariance, int first);

}  // namespace lapis::slam
