#pragma once

#include <optional>

#include "common/time/time.hpp"
#include "planner/core/space/cell.hpp"

namespace lapis::planner {

/// Distance and time without progress that are allowed in addition to twice the longest path that began meanwhile.
struct Allowance {
  double metres = 15.0;   ///< in [1, 1000]
  double seconds = 60.0;  ///< in [1, 3600]
};

/// Notices when the robot drives or turns and sees nothing new. It may cross known space to a distant place and return,
/// and drive a little more. Progress is an increase of the explored volume by 0.5 m^3 or by a thousandth of it,
/// whichever is larger.
class ProgressWatch {
 public:
  explicit ProgressWatch(const Allowance& allowance) : allowance_(allowance) {}

  void note(double explored_m3, const Eigen::Vector2d& robot_map, time::Time now);
  /// A path of this cost [m] begins.
  void set_out(double cost_m);
  bool is_stalled() const;
  /// Resets the watch as progress does.
  void begin_anew();

 private:
  Allowance allowance_;
  double explored_m3_ = 0.0;                 ///< at the last progress, or after it shrank
  double driven_m_ = 0.0, longest_m_ = 0.0;  ///< since the last progress
  double passed_s_ = 0.0;                    ///< since the last progress
  std::optional<Eigen::Vector2d> robot_map_;
  time::Time noted_at_;
};

}  // namespace lapis::planner
