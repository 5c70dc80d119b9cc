#pragma once

#include <Eigen/Core>

namespace lapis::planner {

/// How much of the evidence of a surface stays in its voxels when it is displaced along its normal by a normal error: a
/// voxel of edge h keeps max(0, 1 - |s| / h) of what a displacement by s leaves in it, so
/// f(sigma) = erf(h / (sqrt(2) sigma)) - sqrt(2 / pi) (sigma / h) (1 - exp(-h^2 / (2 sigma^2))).
/// 1 at sigma = 0, falling; in [0, 1].
/// @param sigma_m standard deviation along the normal, >= 0, possibly infinite
/// @param edge_m of a voxel
double surviving_share(double sigma_m, double edge_m);

/// Standard deviation of the displacement, along its normal, of a surface that a key-frame has seen at a range ahead,
/// the mean over all directions of the normal in the plane: sqrt(1/2 tr(J S J^T)), J = [I | r n], n across the heading.
/// @param covariance S of (x, y, heading) in the map frame [m, rad]
/// @param forward direction of the camera in the map frame; only x and y count, and must not both be zero
double surface_sigma_m(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& forward, double range_m);

/// What a displacement leaves of a surface's evidence, the mean over all directions of the normal in the plane: of
/// max(0, 1 - |d cos(phi)| / h).
double surviving_share_of(const Eigen::Vector2d& displacement_m, double edge_m);

}  // namespace lapis::planner
