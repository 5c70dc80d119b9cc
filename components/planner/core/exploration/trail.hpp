#pragma once

#include <deque>
#include <optional>

#include "planner/core/space/cell.hpp"

namespace lapis::planner {

inline constexpr double kMotion_m = 0.3, kMotion_rad = 0.3;  ///< smaller motions count as standing still

inline bool has_moved(const Pose2& from, const Pose2& to) {
  return (to.p_map - from.p_map).norm() > kMotion_m || turn_between(to.yaw_rad, from.yaw_rad) > kMotion_rad;
}

/// The newest poses at which slam tracked; slam may track again there.
class Trail {
 public:
  void add(const Pose2& tracked);
  /// slam stopped tracking: the path back begins at the last pose at which it tracked.
  void turn_back();
  /// Sorted by time, the newest last.
  const std::deque<Pose2>& poses() const { return poses_; }
  /// Forgets the pose nearest to `place` in position and heading: it was reached without success, or cannot be reached.
  void drop_nearest(const Pose2& place);
  /// True when the robot's last turn was to the left.
  bool turned_left() const { return turned_left_; }
  void clear();

 private:
  std::deque<Pose2> poses_;  ///< the oldest first; add() stores one per motion of more than kMotion_m or kMotion_rad
  std::optional<Pose2> newest_;
  bool turned_left_ = false;
};

}  // namespace lapis::planner
