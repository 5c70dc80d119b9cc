#pragma once

#include <optional>
#include <span>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"
#include "slam/core/tracking/pose_refiner.hpp"

namespace lapis::slam {

/// T_reference_camera from points and the pixels that show them, and the number of pixels that it explains.
struct SolvedPose {
  geometry::Pose T_reference_camera = geometry::Pose::Identity();
  int inliers = 0;
};
/// By P3P and RANSAC with a fixed seed. Nothing when no pose explains `min_inliers` of the points.
std::optional<SolvedPose> solve_pose(const TrackerConfig& config, const geometry::PinholeCamera& camera,
                                     std::span<const PointConstraint> points);

}  // namespace lapis::slam
