#pragma once

namespace lapis::controller {

/// What the robot is and can do; see common/robot.
struct RobotLimits {
  double radius_m = 0.20;  ///< of the disc that the robot fills
  double max_speed_m_s = 0.6;
  double max_turn_rate_rad_s = 0.8;
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  double reaction_s = 0.3;  ///< from an obstacle's appearance until the drives obey
};

struct Velocity {
  double forward_m_s = 0.0;
  double turn_rad_s = 0.0;  ///< to the left
};

/// Largest speed from which the robot stands still within `distance_m`, its reaction included [m/s].
double stopping_speed(double distance_m, const RobotLimits& limits);

/// `wanted` within the limits of speed, and of acceleration since `last`, `elapsed_s` ago. The turn rate keeps the
/// curvature of `wanted` as far as it can. Standing still is not ramped: the drives brake as hard as they may.
Velocity ramped(const Velocity& last, const Velocity& wanted, double elapsed_s, const RobotLimits& limits);

}  // namespace lapis::controller
