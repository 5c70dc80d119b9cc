#pragma once

#include <deque>
#include <optional>

#include "planner/core/space/cell.hpp"

namespace lapis::planner {

inline constexpr double kMotion_m = 0.3, kMotion_rad = 0.3;  ///< less is standing still

inline bool has_moved(const Pose2& from, const Pose2& to) {
  return (to.p_map - from.p_map).norm() > kMotion_m || turn_between(to.yaw_rad, from.yaw_rad) > kMotion_rad;
}

/// Poses at which slam tracked, the newest ones: where it may track again.
class Trail {
 public:
  void add(const Pose2& tracked);
  /// Slam stopped tracking: the path back begins with the pose at which it last did.
  void turn_back();
  /// The newest last.
  const std::deque<Pose2>& poses() const { return poses_; }
  /// It has been reached, or cannot be, and slam does not track: the pose that is meant, of place and heading, is of no
  /// use.
  void drop_nearest(const Pose2& place);
  /// Its last turn was to the left.
  bool turned_left() const { return turned_left_; }
  void clear();

 private:
  std::deque<Pose2> poses_;  ///< each somewhere else than the one before
  std::optional<Pose2> newest_;
  bool turned_left_ = false;
};

}  // namespace lapis::planner
