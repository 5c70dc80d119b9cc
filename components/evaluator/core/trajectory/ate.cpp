#include "evaluator/core/trajectory/ate.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lapis::evaluator {
namespace {

Eigen::Vector3d centroid(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

geometry::Pose find_alignment(std::span<const Match> matches, Alignment alignment) {
  if (alignment == Alignment::kNone) return geometry::Pose::Identity();
  if (alignment == Alignment::kOrigin) {
    return matches.front().T_world_reference * matches.front().T_world_estimate.inverse();
  }
  std::vector<Eigen::Vector3d> p_reference;
  std::vector<Eigen::Vector3d> p_estimate;
  for (const Match& match : matches) {
    p_reference.emplace_back(match.T_world_reference.translation());
    p_estimate.emplace_back(match.T_world_estimate.translation());
  }
  return align_points(p_reference, p_estimate);
}

// Angle of the twist about z in the decomposition R = swing * twist.
double twist_about_z(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  double angle = 2.0 * std::atan2(q.z(), q.w());
  if (angle > std::numbers::pi) angle -= 2.0 * std::numbers::pi;
  if (angle <= -std::numbers::pi) angle += 2.0 * std::numbers::pi;
  return angle;
}

}  // namespace

geometry::Pose align_points(std::span<const Eigen::Vector3d> p_a, std::span<const Eigen::Vector3d> p_b) {
  if (p_a.size() != p_b.size() || p_a.empty()) {
    throw std::invalid_argument("align_points needs two point lists of one size, not empty");
  }
  const Eigen::Vector3d mean_a = centroid(p_a);
  const Eigen::Vector3d mean_b = centroid(p_b);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < p_a.size(); ++i) covariance += (p_a[i] - mean_a) * (p_b[i] - mean_b).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // S replaces a reflection, which the SVD may give, by the best proper rotation (eq. 43).
  Eigen::Vector3d S = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) S.z() = -1.0;
  geometry::Pose T_a_b = geometry::Pose::Identity();
  T_a_b.linear() = svd.matrixU() * S.asDiagonal() * svd.matrixV().transpose();
  T_a_b.translation() = mean_a - T_a_b.linear() * mean_b;
  return T_a_b;
}

std::optional<AbsoluteError> absolute_error(std::span<const Match> matches, Alignment alignment) {
  if (matches.empty()) return std::nullopt;
  AbsoluteError result;
  result.T_reference_estimate = find_alignment(matches, alignment);
  std::vector<double> positions;
  std::vector<double> headings;
  for (const Match& match : matches) {
    const geometry::Pose aligned = result.T_reference_estimate * match.T_world_estimate;
    const double position = (aligned.translation() - match.T_world_reference.translation()).norm();
    const double heading = twist_about_z(aligned.linear() * match.T_world_reference.linear().transpose());
    result.poses.push_back({match.stamp, position, heading});
    positions.push_back(position);
    headings.push_back(std::abs(heading));
  }
  result.position_m = *error_statistics(std::move(positions));
  result.heading_rad = *error_statistics(std::move(headings));
  return result;
}

}  // namespace lapis::evaluator
