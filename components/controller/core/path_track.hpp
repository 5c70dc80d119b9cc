#pragma once

#include <optional>
#include <vector>

#include "controller/core/planar.hpp"

namespace lapis::controller {

/// What a path in base_link asks for: to turn through the headings of its poses, each the short way from the one
/// before, the first from straight ahead; their sum [rad, to the left]. Nothing when it is empty or leads away (1 cm).
std::optional<double> turn_on_the_spot(const std::vector<PlanarPose>& poses);

/// A path in the map frame and how far the robot has come on it.
class PathTrack {
 public:
  /// `poses`: at least one; the last one's heading is the final one. When the first ones are at one place (1 cm) and
  /// differ in heading, these are turned through, each the short way from the one before, before it is left.
  explicit PathTrack(std::vector<PlanarPose> poses);

  /// The heading of the first turn that the robot has to turn to next; nothing when it has turned.
  /// @param yaw_rad of the robot
  std::optional<double> next_heading(double yaw_rad);

  /// Moves on to the point of the next `window_m` of the path that is nearest to the robot; never back.
  void advance(const Eigen::Vector2d& position, double window_m);
  double progress_m() const { return progress_m_; }
  /// Length of the rest.
  double left_m() const { return along_m_.back() - progress_m_; }
  /// The point so far ahead on the path, or its end.
  Eigen::Vector2d ahead(double distance_m) const { return point_at(progress_m_ + distance_m); }
  const PlanarPose& end() const { return poses_.back(); }
  const std::vector<PlanarPose>& poses() const { return poses_; }

 private:
  Eigen::Vector2d point_at(double along_m) const;

  std::vector<PlanarPose> poses_;
  std::vector<double> along_m_;  // of each pose
  double progress_m_ = 0.0;
  std::size_t turned_ = 0, turns_ = 0;  // poses of the first turn: those that are done, and all
};

}  // namespace lapis::controller
