#pragma once

#include <optional>

#include "common/time/time.hpp"
#include "planner/core/space/cell.hpp"

namespace lapis::planner {

/// Driven and passed without progress, besides twice the longest path that was set out on meanwhile.
struct Allowance {
  double metres = 15.0;   ///< in [1, 1000]
  double seconds = 60.0;  ///< in [1, 3600]
};

/// Notices when the robot drives, or turns, and sees nothing new: it may go to a far place through what it knows, there
/// and back, and a little more. Progress is half a cubic metre, or a thousandth of what is explored.
class ProgressWatch {
 public:
  explicit ProgressWatch(const Allowance& allowance) : allowance_(allowance) {}

  void note(double explored_m3, const Eigen::Vector2d& robot_map, time::Time now);
  /// A path of this cost begins.
  void set_out(double cost_m);
  bool is_stalled() const;
  /// As after progress.
  void begin_anew();

 private:
  Allowance allowance_;
  double explored_m3_ = 0.0;                 ///< at the last progress
  double driven_m_ = 0.0, longest_m_ = 0.0;  ///< since
  double passed_s_ = 0.0;                    ///< since
  std::optional<Eigen::Vector2d> robot_map_;
  time::Time noted_at_;
};

}  // namespace lapis::planner
