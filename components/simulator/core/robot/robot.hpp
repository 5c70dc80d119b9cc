#pragma once

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "simulator/core/robot/nav_map.hpp"

namespace lapis::simulator {

/// Speed and turn rate, as commanded by /cmd_vel.
struct DriveCommand {
  double speed_m_s = 0.0;
  double turn_rate_rad_s = 0.0;  ///< to the left
};

/// What the drives make of speed and turn rate, as factors.
struct DriveFactors {
  double speed = 1.0;
  double turn_rate = 1.0;
};

struct RobotConfig {
  double radius_m = 0.20;
  double max_speed_m_s = 0.6;  ///< forwards and backwards
  double max_turn_rate_rad_s = 0.8;
  double lag_s = 0.15;  ///< time constant of both drives, > 0
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  time::Duration command_timeout{500'000'000};  ///< after this time without a command the robot stops
};

/// Pose and motion at one moment, in the world frame; angles are positive to the left.
struct RobotState {
  time::Time stamp;
  Eigen::Vector2d position{0, 0};  ///< of the disc's centre [m]
  double yaw_rad = 0.0;            ///< in [-pi, pi]
  DriveCommand drive;              ///< speed and turn rate of the drives, in contact or not
  Eigen::Vector2d velocity{0, 0};  ///< true velocity of the body, forwards and to the left [m/s]
  DriveCommand target;             ///< last accepted command, within the limits, as the drives take it
  time::Time target_stamp;         ///< when it was given
};

/// True motion over an interval, which wheel odometry and IMU measure.
struct Motion {
  double duration_s = 0.0;
  double distance_m = 0.0;             ///< along the heading: the wheels roll this far
  double turn_rad = 0.0;               ///< the wheels turn the robot by this angle
  double slide_m = 0.0;                ///< to the left, along an obstacle: the wheels do not measure it
  Eigen::Vector2d acceleration{0, 0};  ///< mean, forwards and to the left at the middle of the turn [m/s2]
  double turn_rate_rad_s = 0.0;        ///< mean
  bool is_in_contact = false;          ///< at some time of the interval
  double push_m_s = 0.0;               ///< greatest speed towards an obstacle while in contact
};

/// A disc with differential drive. Speed and turn rate follow commands with a first-order lag and limited
/// acceleration; the pose is integrated along arcs in steps of at most 5 ms. When the disc would enter an obstacle, it
/// is moved back to the free side, and so slides along it. The motion is deterministic; copies are independent.
class Robot {
 public:
  /// @param map must outlive the robot.
  /// @throws std::runtime_error when the disc does not fit at the start.
  Robot(const NavMap& map, const RobotConfig& config, const RobotState& start);

  const RobotState& state() const { return state_; }
  /// From now on the robot follows `command`, clamped to the limits, times what its drives make of it. A command that
  /// is not finite is refused (false) and stops the robot.
  [[nodiscard]] bool command(const DriveCommand& command, const DriveFactors& factors = {});
  /// Moves the robot until the time `until`; nothing happens when that is not later than the state.
  Motion advance(time::Time until);

 private:
  struct Roll {
    double distance_m, turn_rad;
  };
  Roll drive_on(double step_s);
  bool move(const Roll& roll, double step_s, Motion& motion);
  Eigen::Vector2d nearest_free(const Eigen::Vector2d& wanted) const;

  const NavMap* map_;
  RobotConfig config_;
  RobotState state_;
};

}  // namespace lapis::simulator
