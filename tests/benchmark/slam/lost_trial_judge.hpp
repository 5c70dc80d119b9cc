#pragma once

#include <string>
#include <vector>

#include "tests/benchmark/slam/lost_trial.hpp"

namespace lapis::slam::benchmark {

/// A trial passes when each figure is within its limit. Errors are those of the camera's position; limits on poses are
/// on top of what the wheels have erred since the last frame that was tracked, when slam gets wheels.
struct TrialLimits {
  double declared_s = 0.5;
  double returned_s = 1.0;
  double jump_m = 0.10;
  double jump_rad = 0.05;
  double false_m = 0.25;  ///< a pose that errs by more is wrong, however sure slam is
};

struct TrialVerdict {
  bool is_void = false;   ///< it says nothing: not tracked before, or no view comes back
  bool was_lost = false;  ///< else tracked through
  double declared_s =
      0.0;  ///< covered: from the first covered frame; else the longest time that a wrong pose was told as tracked
  double jump_m = 0.0;       ///< largest difference of successive told poses from the true motion
  double jump_rad = 0.0;     ///< the same, rotation
  bool jumps_away = false;   ///< a jump beyond the limits that is no correction towards the truth
  bool touches_map = false;  ///< graph version, key-frames or landmarks changed in a frame that was not tracked
  double returned_s = 0.0;   ///< from the view's return to the first tracked frame
  double error_m = 0.0;      ///< on return, of the motion since the last tracked frame
  double error_rad = 0.0;
  double wheels_m = 0.0;  ///< the wheels' error of the same motion
  double wheels_rad = 0.0;
  double end_m = 0.0;   ///< error of the last pose, from the start on
  std::string failure;  ///< empty: passed
};

TrialVerdict judge(const std::vector<TrialStep>& steps, const TrialLimits& limits, bool is_covered, bool with_wheels);

}  // namespace lapis::slam::benchmark
