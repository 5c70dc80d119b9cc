#pragma once

#include <vector>

#include "controller/core/planar.hpp"

namespace lapis::controller {

/// A path in the map frame and how far the robot has come on it.
class PathTrack {
 public:
  /// `poses`: at least one; the last one's heading is the final one.
  explicit PathTrack(std::vector<PlanarPose> poses);

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
};

}  // namespace lapis::controller
