#include "slam/core/tracking/pose_solver.hpp"

#include <vector>

#include <opencv2/calib3d.hpp>

namespace lapis::slam {

std::optional<SolvedPose> solve_pose(const TrackerConfig& config, const geometry::PinholeCamera& camera,
                                     std::span<const PointConstraint> points) {
  if (points.size() < static_cast<std::size_t>(config.min_inliers)) return std::nullopt;
  std::vector<cv::Point3d> known;
  std::vector<cv::Point2d> shown;
  for (const PointConstraint& point : points) {
    known.emplace_back(point.p_reference.x(), point.p_reference.y(), point.p_reference.z());
    shown.emplace_back(point.pixel.x(), point.pixel.y());
  }
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation;
  cv::Vec3d translation;
  std::vector<int> inliers;
  // OpenCV's RANSAC seeds its own generator with a constant: the same input gives the same pose.
  const bool found =
      cv::solvePnPRansac(known, shown, K, cv::noArray(), rotation, translation, false, config.ransac_iterations,
                         static_cast<float>(config.ransac_error_px), 0.999, inliers, cv::SOLVEPNP_AP3P);
  if (!found || inliers.size() < static_cast<std::size_t>(config.min_inliers)) return std::nullopt;
  geometry::Pose T_camera_reference = geometry::Pose::Identity();
  T_camera_reference.linear() = geometry::so3_exp({rotation[0], rotation[1], rotation[2]});
  T_camera_reference.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
  if (!geometry::is_valid(T_camera_reference)) return std::nullopt;
  return SolvedPose{T_camera_reference.inverse(), static_cast<int>(inliers.size())};
}

}  // namespace lapis::slam
