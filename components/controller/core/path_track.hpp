#pragma once

#include <optional>
#include <vector>

#include "controller/core/planar.hpp"

namespace lapis::controller {

/// Angle of the turn on the spot that a path in base_link describes [rad, positive to the left]: the sum of the turns
/// through the headings of its poses, each the short way from the previous one, the first from straight ahead. Nothing
/// when the path is empty or leaves the spot (by more than 1 cm).
std::optional<double> turn_on_the_spot(const std::vector<PlanarPose>& poses);

/// A path in the map frame and the robot's progress on it.
class PathTrack {
 public:
  /// `poses`: at least one; the heading of the last one is the final heading. When the first poses are at one place
  /// (within 1 cm) and differ in heading, the robot first turns through these headings, each the short way from the
  /// previous one.
  explicit PathTrack(std::vector<PlanarPose> poses);

  /// The next heading of the first turn [rad]; nothing when that turn is done.
  /// @param yaw_rad heading of the robot in the map frame
  std::optional<double> next_heading(double yaw_rad);

  /// Advances the progress to the point nearest to the robot within the next `window_m` of the path; never moves back.
  void advance(const Eigen::Vector2d& position, double window_m);
  double progress_m() const { return progress_m_; }
  /// Length of the rest of the path.
  double left_m() const { return along_m_.back() - progress_m_; }
  /// The point this far ahead on the path, or its end.
  Eigen::Vector2d ahead(double distance_m) const { return point_at(progress_m_ + distance_m); }
  const PlanarPose& end() const { return poses_.back(); }
  const std::vector<PlanarPose>& poses() const { return poses_; }

 private:
  Eigen::Vector2d point_at(double along_m) const;

  std::vector<PlanarPose> poses_;
  std::vector<double> along_m_;  // distance of each pose along the path
  double progress_m_ = 0.0;
  std::size_t turned_ = 0, turns_ = 0;  // poses of the first turn: those that are done, and all of them
};

}  // namespace lapis::controller
