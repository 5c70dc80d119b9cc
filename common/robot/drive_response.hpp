#pragma once

namespace lapis::robot {

/// Speed of a drive after some time, and the path or angle in between.
struct DriveResponse {
  double value;
  double integral;
};

/// A drive that follows its target with a first-order lag and limited acceleration: the solution after `elapsed_s` of
/// v' = clamp((target - v) / lag, -limit, limit), and its integral. Units are those of v; `lag_s` and `limit` > 0.
DriveResponse drive_response(double v, double target, double elapsed_s, double lag_s, double limit);

}  // namespace lapis::robot
