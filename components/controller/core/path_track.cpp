#include "controller/core/path_track.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lapis::controller {
namespace {

constexpr double kOnTheSpot_m = 0.01;
constexpr double kTurned_rad = 0.3;  // the rest of a first turn is done while driving

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
  const auto leaves = std::find_if(poses_.begin(), poses_.end(), [&](const PlanarPose& pose) {
    return (pose.translation() - poses_.front().translation()).norm() > kOnTheSpot_m;
  });
  const bool turns = std::any_of(poses_.begin(), leaves, [&](const PlanarPose& pose) {
    return std::abs(wrapped(yaw_of(pose) - yaw_of(poses_.front()))) > kTurned_rad;
  });
  if (turns) turns_ = static_cast<std::size_t>(leaves - poses_.begin());
}

// Skips headings that the robot has passed already, because it continued to turn while the path was planned.
std::optional<double> PathTrack::next_heading(double yaw_rad) {
  const auto off_rad = [&](std::size_t i) { return std::abs(wrapped(yaw_of(poses_[i]) - yaw_rad)); };
  const auto is_beyond = [&] { return turned_ + 1 < turns_ && off_rad(turned_ + 1) < off_rad(turned_); };
  while (turned_ < turns_ && (off_rad(turned_) <= kTurned_rad || is_beyond())) ++turned_;
  if (turned_ == turns_) return std::nullopt;
  return yaw_of(poses_[turned_]);
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
  const auto i = static_cast<std::size_t>(next - along_m_.begin());  // at least 1, because the first pose is at 0
  const double share = (along_m - along_m_[i - 1]) / (along_m_[i] - along_m_[i - 1]);
  return poses_[i - 1].translation() + share * (poses_[i].translation() - poses_[i - 1].translation());
}

}  // namespace lapis::controller
