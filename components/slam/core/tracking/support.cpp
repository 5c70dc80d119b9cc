#include "slam/core/tracking/support.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/core/tracking/pose_solver.hpp"

namespace lapis::slam {
namespace {

bool exceeds(const TrackerConfig& config, int agree, double against) {
  return agree - against >= config.rival_sigmas * std::sqrt(agree + against);
}

}  // namespace

Support find_support(const TrackerConfig& config, const geometry::PinholeCamera& camera,
                     std::span<const PointConstraint> points, const geometry::Pose& T_reference_camera,
                     double window_px2) {
  const geometry::Pose T_camera_reference = T_reference_camera.inverse();
  std::vector<PointConstraint> others = witnesses(config, points);
  Support support;
  support.of = static_cast<int>(others.size());
  std::erase_if(others, [&](const PointConstraint& point) {
    return pixel_error(camera, point, T_camera_reference) <= config.ransac_error_px;
  });
  support.agree = support.of - static_cast<int>(others.size());
  support.by_chance = support.of * std::min(1.0, M_PI * std::pow(config.ransac_error_px, 2) / window_px2);
  if (exceeds(config, support.agree, static_cast<double>(others.size()))) return support;
  if (const auto rival = solve_pose(config, camera, others)) support.rivals = rival->inliers;
  return support;
}

std::vector<PointConstraint> witnesses(const TrackerConfig& config, std::span<const PointConstraint> points) {
  std::vector<PointConstraint> counted(points.begin(), points.end());
  if (has_witnesses(config, points)) std::erase_if(counted, [](const auto& point) { return !point.is_confirmed; });
  return counted;
}

bool is_significant(const TrackerConfig& config, const Support& support) {
  return exceeds(config, support.agree, std::max(static_cast<double>(support.rivals), support.by_chance));
}

}  // namespace lapis::slam
