#pragma once

#include <string>
#include <vector>

#include "tests/benchmark/slam/lost_trial.hpp"
#include "tests/benchmark/slam/pose_error.hpp"

namespace lapis::slam::benchmark {

/// Limits on poses are on top of what odometry has erred meanwhile, when slam gets them.
struct TrialLimits {
  double declared_s = 0.5;
  double returned_s = 1.0;
  double jump_m = 0.10;
  double jump_rad = 0.05;
  double wrong_m = 0.25;  ///< a pose that errs by more is wrong, however sure slam is ...
  double drift = 0.05;    ///< ... on top of this share of the path so far
};

struct TrialVerdict {
  bool is_void = false;   ///< it says nothing: not tracked before, or no view comes back
  bool was_lost = false;  ///< else tracked through
  double declared_s =
      0.0;         ///< covered: from the first covered frame on; else longest time that wrong poses were reported
  PoseError jump;  ///< largest differences of successive published poses from the true motion
  bool jumps_away = false;   ///< a jump beyond the limits, and not towards the truth
  bool touches_map = false;  ///< graph version, key-frames or landmarks changed in a frame that was not tracked
  double returned_s = 0.0;   ///< from the view's return to the first tracked frame
  PoseError before;          ///< in the map: of the last tracked pose
  PoseError returned;        ///< ... of the first one afterwards
  PoseError odometry;        ///< of its motion between these two
  PoseError end;             ///< in the map: of the last pose
  std::string failure;       ///< what is beyond its limit; empty: passed
};

/// `steps` of at least one frame. `is_covered`: the plan covers the camera.
TrialVerdict judge(const std::vector<TrialStep>& steps, const TrialLimits& limits, bool is_covered, bool with_odometry);

}  // namespace lapis::slam::benchmark
