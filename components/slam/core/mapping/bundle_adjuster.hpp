#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

struct BundleCamera {
  geometry::PinholeCamera camera;
  geometry::Pose T_map_camera = geometry::Pose::Identity();
  bool is_fixed = false;
};

/// Camera `camera` shows point `point` at a pixel, with a depth or without one (0).
struct BundleObservation {
  std::size_t camera = 0;
  std::size_t point = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< [px]
  double sigma_px = 1.0;                            ///< [px]
  double depth_m = 0.0;                             ///< [m]
};

/// Measured relative pose of two cameras; the information is that of a right perturbation of T_from_to.
struct BundleLink {
  std::size_t from = 0;
  std::size_t to = 0;
  geometry::Pose T_from_to = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Identity();  ///< positive semi-definite
};

/// Cameras and points to be adjusted in place. At least one camera must be fixed (gauge).
struct BundleProblem {
  std::vector<BundleCamera> cameras;
  std::vector<Eigen::Vector3d> points_map;  ///< [m]
  std::vector<BundleObservation> observations;
  std::vector<BundleLink> links;
};

struct BundleReport {
  bool is_usable = false;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
};

/// Minimises the errors of reprojection, depth and links, all with a robust loss (Huber), by Ceres in one thread and in
/// at most BundleConfig::max_iterations. Observations of points behind their camera are left out. On failure nothing
/// changes.
BundleReport adjust_bundle(const BundleConfig& config, const NoiseConfig& noise, BundleProblem& problem);

/// Whitened residual (u, v, depth) of an observation and its Jacobians, 3 x 6 by a right perturbation of T_map_camera
/// and 3 x 3 by the point; either may be null. False when the point is not in front of the camera.
bool bundle_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                     const BundleObservation& observation, const geometry::Pose& T_map_camera,
                     const Eigen::Vector3d& p_map, Eigen::Vector3d& residual, Eigen::Matrix<double, 3, 6>* by_pose,
                     Eigen::Matrix3d* by_point);

/// Error log(T_from_to^-1 * T_map_from^-1 * T_map_to) of a link and its Jacobians by right perturbations of both poses.
geometry::Vector6d link_error(const BundleLink& link, const geometry::Pose& T_map_from, const geometry::Pose& T_map_to,
                              geometry::Matrix6d* by_from, geometry::Matrix6d* by_to);

}  // namespace lapis::slam
