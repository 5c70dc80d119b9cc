#include "controller/core/path_fan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace lapis::controller {
namespace {

constexpr double kGrowth = 1.6;  // curvatures are denser near 0, which the robot drives most

void require(bool is_met, const std::string& what) {
  if (!is_met) throw std::runtime_error("fan: " + what);
}

/// `count` curvatures from -max to max; odd counts have 0 in the middle.
std::vector<double> curvatures(int count, double max_per_m) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double share = count == 1 ? 0.0 : 2.0 * i / (count - 1) - 1.0;
    values.push_back(std::copysign(max_per_m * std::pow(std::abs(share), kGrowth), share));
  }
  return values;
}

/// Pose after an arc from the origin.
PlanarPose arc(double length_m, double curvature_per_m) {
  const double turn = length_m * curvature_per_m;
  const double half = 0.5 * turn;
  const double chord_m = std::abs(half) < 1e-9 ? length_m : length_m * std::sin(half) / half;
  return planar_pose(chord_m * Eigen::Vector2d(std::cos(half), std::sin(half)), turn);
}

}  // namespace

PathFan::PathFan(const FanConfig& config, double radius_m) : groups_(static_cast<std::size_t>(config.groups)) {
  config::check("fan", config);
  require(config.groups % 2 == 1, "groups must be odd");
  require(config.branches % 2 == 1, "branches must be odd");
  require(radius_m > 0.0, "the robot's radius must be positive");
  reach_m_ = config.length_m + radius_m + config.margin_m;
  cells_per_side_ = 2 * static_cast<int>(std::ceil(reach_m_ / kStep_m));
  make_paths(config);
  make_table(config, radius_m);
}

void PathFan::make_paths(const FanConfig& config) {
  const auto first = curvatures(config.groups, config.max_curvature_per_m);
  const auto second = curvatures(config.branches, config.max_curvature_per_m);
  const int steps = static_cast<int>(std::lround(config.length_m / kStep_m));
  for (std::size_t group = 0; group < first.size(); ++group) {
    for (const double later : second) {
      FanPath path{group, first[group], later, {PlanarPose::Identity()}};
      for (int i = 1; i <= steps; ++i) {
        const PlanarPose T = path.poses.back() * arc(kStep_m, 2 * i <= steps ? first[group] : later);
        if (std::abs(bearing(T.translation())) > config.max_bearing_rad) break;
        path.poses.push_back(T);
      }
      lengths_.push_back(static_cast<std::uint8_t>(path.poses.size()));
      paths_.push_back(std::move(path));
    }
  }
}

void PathFan::make_table(const FanConfig& config, double radius_m) {
  table_.reserve(static_cast<std::size_t>(cells_per_side_ * cells_per_side_) * paths_.size());
  const double corner_m = -0.5 * cells_per_side_ * kStep_m;
  for (int row = 0; row < cells_per_side_; ++row) {
    for (int column = 0; column < cells_per_side_; ++column) {
      const Eigen::Vector2d center(corner_m + (column + 0.5) * kStep_m, corner_m + (row + 0.5) * kStep_m);
      for (const FanPath& path : paths_) table_.push_back(free_poses(path, center, config, radius_m));
    }
  }
}

std::uint8_t PathFan::free_poses(const FanPath& path, const Eigen::Vector2d& obstacle, const FanConfig& config,
                                 double radius_m) const {
  const double now_m = obstacle.norm();
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const double ramp = std::lerp(kLeastShare, 1.0, std::min(1.0, static_cast<double>(i) * kStep_m / kRamp_m));
    const double distance_m = (path.poses[i].translation() - obstacle).norm();
    const bool is_too_near = distance_m < radius_m + ramp * config.margin_m;
    if (is_too_near && distance_m < now_m - kNearer_m) return static_cast<std::uint8_t>(i);
  }
  return static_cast<std::uint8_t>(path.poses.size());
}

/// Entries of the table for the cell that contains a point; null outside the table.
const std::uint8_t* PathFan::cell(const Eigen::Vector2d& p) const {
  const double half = 0.5 * cells_per_side_;
  const int column = static_cast<int>(std::floor(p.x() / kStep_m + half));
  const int row = static_cast<int>(std::floor(p.y() / kStep_m + half));
  if (column < 0 || row < 0 || column >= cells_per_side_ || row >= cells_per_side_) return nullptr;
  return table_.data() + static_cast<std::size_t>(row * cells_per_side_ + column) * paths_.size();
}

std::vector<std::uint8_t> PathFan::free_poses(std::span<const Eigen::Vector2d> obstacles, double heading_rad) const {
  std::vector<std::uint8_t> free = lengths_;
  const Eigen::Matrix2d R_heading_base = Eigen::Rotation2Dd(-heading_rad).toRotationMatrix();
  for (const Eigen::Vector2d& p_base : obstacles) {
    const std::uint8_t* allowed = cell(R_heading_base * p_base);
    if (allowed == nullptr) continue;
    for (std::size_t i = 0; i < free.size(); ++i) free[i] = std::min(free[i], allowed[i]);
  }
  return free;
}

std::size_t PathFan::path_along(double curvature_per_m) const {
  const auto difference = [curvature_per_m](const FanPath& path) {
    return std::pair(std::abs(path.curvature_per_m - curvature_per_m), std::abs(path.later_per_m - curvature_per_m));
  };
  const auto nearest = std::min_element(
      paths_.begin(), paths_.end(), [&](const FanPath& a, const FanPath& b) { return difference(a) < difference(b); });
  return static_cast<std::size_t>(nearest - paths_.begin());
}

}  // namespace lapis::controller
