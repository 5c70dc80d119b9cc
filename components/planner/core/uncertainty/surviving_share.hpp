#pragma once

#include <Eigen/Core>

namespace lapis::planner {

/// Share of a surface's evidence that stays in its voxels when a Gaussian error displaces the surface along its normal.
/// A voxel of edge h keeps max(0, 1 - |s| / h) of its evidence after a displacement by s, so
/// f(sigma) = erf(h / (sqrt(2) sigma)) - sqrt(2 / pi) (sigma / h) (1 - exp(-h^2 / (2 sigma^2))).
/// f is 1 at sigma = 0 and decreases; it is in [0, 1].
/// @param sigma_m standard deviation along the normal, >= 0, possibly infinite
/// @param edge_m edge of a voxel
double surviving_share(double sigma_m, double edge_m);

/// Standard deviation of the displacement, along its normal, of a surface that a key-frame has seen at range r straight
/// ahead: the root mean square over all directions of the normal in the plane, sqrt(1/2 tr(J S J^T)) with J =
/// [I | r n], where n is perpendicular to the heading.
/// @param covariance S of (x, y, heading) in the map frame [m, rad]
/// @param forward direction of the camera in the map frame; only x and y count, and they must not both be zero
double surface_sigma_m(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& forward, double range_m);

/// Share of a surface's evidence that remains after a displacement d: the mean of max(0, 1 - |d cos(phi)| / h) over all
/// directions of the normal in the plane, where h is the edge of a voxel.
double surviving_share_of(const Eigen::Vector2d& displacement_m, double edge_m);

}  // namespace lapis::planner
