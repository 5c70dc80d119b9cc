#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame/surface.hpp"

namespace lapis::slam {

/// A known point and the feature that shows it.
struct PointConstraint {
  Eigen::Vector3d p_reference = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();        ///< [px]
  double depth_m = 0.0;                                   ///< measured z-depth, 0 = none
  double sigma_px = 1.0;                                  ///< of the pixel [px]
  bool is_confirmed = true;  ///< several key-frames have seen it; else it may be of something that moves
};

/// Prior of the pose.
struct PosePrior {
  geometry::Pose T_reference_camera = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();  ///< right perturbation
};

/// What a frame measures of its pose relative to a reference frame. The spans and the image must outlive it.
struct AlignmentProblem {
  geometry::PinholeCamera camera;
  std::span<const PointConstraint> points;
  std::span<const SurfaceSample> surface;         ///< in the reference frame
  const geometry::DepthImage* depth = nullptr;    ///< of the frame; needed when there are surface samples
  std::optional<PosePrior> prior = std::nullopt;  ///< determines the directions that the measurements leave open
};

/// Refined pose and how well it explains the measurements.
struct Alignment {
  geometry::Pose T_reference_camera = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();  ///< right perturbation, not yet bounded; without prior
  geometry::Matrix6d surface_information = geometry::Matrix6d::Zero();  ///< the surface's share of `information`
  std::vector<bool> is_inlier;                                          ///< of each point
  int inliers = 0;
  double rms_px = 0.0;            ///< reprojection error of the inliers
  int surface_matches = 0;        ///< samples that found their surface again
  double surface_rms_m = 0.0;     ///< RMS plane distance of these
  double surface_variance = 1.0;  ///< of unit weight: `surface_information` is the Hessian divided by it
};

/// Distance of the pixel from where the pose has the point [px]; infinite behind the camera.
double pixel_error(const geometry::PinholeCamera& camera, const PointConstraint& point,
                   const geometry::Pose& T_camera_reference);

/// Whitened residual (u, v, depth) of a point and its Jacobian by a right perturbation of T_reference_camera, whose
/// inverse is given. The depth row is zero without a measured depth. Nothing when the point is not in front of the
/// camera.
struct PointResidual {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  std::array<geometry::Vector6d, 3> jacobian{};  ///< a row each
};
std::optional<PointResidual> point_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                            const PointConstraint& point, const geometry::Pose& T_camera_reference);

/// Distance [m] from the plane of a sample to the point that the frame sees at the sample's pixel, positive towards the
/// camera, and its Jacobian by a right perturbation of T_reference_camera for this pair of points (point-to-plane
/// alignment [Chen 1991] with projective association [Blais 1995]). Nothing when the frame has no depth there.
struct SurfaceResidual {
  double distance_m = 0.0;
  double sigma_m = 1.0;  ///< of the distance, from the depth noise
  geometry::Vector6d jacobian = geometry::Vector6d::Zero();
};
std::optional<SurfaceResidual> surface_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                                const geometry::DepthImage& depth, const SurfaceSample& sample,
                                                const geometry::Pose& T_camera_reference);

/// Whether the confirmed points alone give a pose: twice TrackerConfig::min_inliers.
bool has_witnesses(const TrackerConfig& config, std::span<const PointConstraint> points);

/// Robust maximum-likelihood pose from points and surfaces, starting at `T_reference_camera`. Where the confirmed
/// points are enough, the others count as far as they agree with them.
Alignment refine_pose(const SlamConfig& config, const AlignmentProblem& problem,
                      const geometry::Pose& T_reference_camera);

}  // namespace lapis::slam
