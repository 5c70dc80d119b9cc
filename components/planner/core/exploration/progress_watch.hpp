#pragma once

#include <optional>

#include "planner/core/space/cell.hpp"

namespace lapis::planner {

/// Growth of the explored volume that is progress [m^3].
inline constexpr double kProgress_m3 = 0.5;

/// Notices when the robot drives and sees nothing new: it may go to a far place through what it knows, there and back,
/// and a little more.
class ProgressWatch {
 public:
  /// @param allowance_m driven without progress besides twice the longest path that was set out on meanwhile
  explicit ProgressWatch(double allowance_m) : allowance_m_(allowance_m) {}

  void note(double explored_m3, const Eigen::Vector2d& robot_map);
  /// A path of this cost begins.
  void set_out(double cost_m);
  bool is_stalled() const { return driven_m_ > allowance_m_ + 2.0 * longest_m_; }
  /// As after progress.
  void begin_anew();

 private:
  double allowance_m_;
  double explored_m3_ = 0.0;                 ///< at the last progress
  double driven_m_ = 0.0, longest_m_ = 0.0;  ///< since
  std::optional<Eigen::Vector2d> robot_map_;
};

}  // namespace lapis::planner
