#pragma once

namespace lapis::controller {

/// Size and limits of the robot; see common/robot.
struct RobotLimits {
  double radius_m = 0.20;  ///< radius of the disc that the robot fills
  double max_speed_m_s = 0.6;
  double max_turn_rate_rad_s = 0.8;
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  double reaction_s = 0.3;  ///< from the appearance of an obstacle until the drives react
};

struct Velocity {
  double forward_m_s = 0.0;
  double turn_rad_s = 0.0;  ///< to the left
};

/// Largest speed from which the robot can stop within `distance_m`, including its reaction time [m/s].
double stopping_speed(double distance_m, const RobotLimits& limits);

/// `wanted`, limited in speed and in acceleration since `last`, which was commanded `elapsed_s` ago. The turn rate
/// keeps the curvature of `wanted` as far as possible. A stop of the forward motion is not ramped: the drives brake as
/// hard as they can.
Velocity ramped(const Velocity& last, const Velocity& wanted, double elapsed_s, const RobotLimits& limits);

}  // namespace lapis::controller
