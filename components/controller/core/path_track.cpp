#include "controller/core/path_track.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace lapis::controller {
namespace {

constexpr double kOnTheSpot_m = 0.01;

}  // namespace

std::optional<double> turn_on_the_spot(const std::vector<PlanarPose>& poses) {
  if (poses.empty()) return std::nullopt;
  double turn_rad = 0.0, heading_rad = 0.0;
  for (const PlanarPose& pose : poses) {
    if (pose.translation().norm() > kOnTheSpot_m) return std::nullopt;
    turn_rad += wrapped(yaw_of(pose) - heading_rad);
    heading_rad = yaw_of(pose);
  }
  return turn_rad;
}

PathTrack::PathTrack(std::vector<PlanarPose> poses) : poses_(std::move(poses)), along_m_{0.0} {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    along_m_.push_back(along_m_.back() + (poses_[i].translation() - poses_[i - 1].translation()).norm());
  }
}

void PathTrack::advance(const Eigen::Vector2d& position, double window_m) {
  const double from = progress_m_;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    const double low = std::max(along_m_[i - 1], from), high = std::min(along_m_[i], from + window_m);
    const double length = along_m_[i] - along_m_[i - 1];
    if (low > high || length <= 0.0) continue;
    const Eigen::Vector2d a = poses_[i - 1].translation(), ab = poses_[i].translation() - a;
    const double along = std::clamp(along_m_[i - 1] + (position - a).dot(ab) / length, low, high);
    const double distance = (point_at(along) - position).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    progress_m_ = along;
  }
}

Eigen::Vector2d PathTrack::point_at(double along_m) const {
  const auto next = std::upper_bound(along_m_.begin(), along_m_.end(), along_m);
  if (next == along_m_.end()) return poses_.back().translation();
  const auto i = static_cast<std::size_t>(next - along_m_.begin());  // at least 1: the first pose lies at 0
  const double share = (along_m - along_m_[i - 1]) / (along_m_[i] - along_m_[i - 1]);
  return poses_[i - 1].translation() + share * (poses_[i].translation() - poses_[i - 1].translation());
}

}  // namespace lapis::controller
