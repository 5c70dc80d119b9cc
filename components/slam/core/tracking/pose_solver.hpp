#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// T_reference_camera from points and the pixels that show them, by P3P and RANSAC with a fixed seed.
/// `points_reference` [m] and `pixels` have the same order. Nothing when no pose explains `min_inliers` of them.
std::optional<geometry::Pose> solve_pose(const TrackerConfig& config, const geometry::PinholeCamera& camera,
                                         const std::vector<Eigen::Vector3d>& points_reference,
                                         const std::vector<Eigen::Vector2d>& pixels);

}  // namespace lapis::slam
