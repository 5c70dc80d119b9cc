#pragma once

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "simulator/core/robot/nav_map.hpp"

namespace lapis::simulator {

/// What /cmd_vel asks for.
struct DriveCommand {
  double speed_m_s = 0.0;
  double turn_rate_rad_s = 0.0;  ///< to the left
};

struct RobotConfig {
  double radius_m = 0.20;
  double max_speed_m_s = 0.6;  ///< forwards and backwards
  double max_turn_rate_rad_s = 0.8;
  double lag_s = 0.15;  ///< time constant of both drives, > 0
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  time::Duration command_timeout{500'000'000};  ///< without a command for so long the robot stops
};

/// Pose and motion at one moment. World frame; angles to the left.
struct RobotState {
  time::Time stamp;
  Eigen::Vector2d position{0, 0};  ///< of the disc's centre [m]
  double yaw_rad = 0.0;            ///< in [-pi, pi]
  DriveCommand drive;              ///< what the drives do, contact or not
  Eigen::Vector2d velocity{0, 0};  ///< what the body really does, forwards and to the left [m/s]
  DriveCommand target;             ///< last accepted command, within the limits
  time::Time target_stamp;         ///< when it was given
};

/// What really happened over an interval: the truth behind wheel odometry and IMU.
struct Motion {
  double duration_s = 0.0;
  double distance_m = 0.0;             ///< along the heading: what wheels roll
  double turn_rad = 0.0;               ///< what wheels turn
  double slide_m = 0.0;                ///< to the left, along an obstacle: wheels do not notice
  Eigen::Vector2d acceleration{0, 0};  ///< mean, forwards and to the left at the middle of the turn [m/s2]
  double turn_rate_rad_s = 0.0;        ///< mean
  bool is_in_contact = false;          ///< at some time
  double push_m_s = 0.0;               ///< then: greatest speed towards the obstacle
};

/// A disc with differential drive. Speed and turn rate follow commands with a first-order lag and limited
/// acceleration; the pose is integrated along arcs in steps of at most 5 ms. Where the disc would enter an obstacle, it
/// is put back to the free side and so slides along. Deterministic; copies are independent.
class Robot {
 public:
  /// @param map must outlive the robot.
  /// @throws std::runtime_error when the disc does not fit at the start.
  Robot(const NavMap& map, const RobotConfig& config, const RobotState& start);

  const RobotState& state() const { return state_; }
  /// From now on the robot follows `command`, clamped to the limits. A command that is not finite is refused (false)
  /// and stops the robot.
  [[nodiscard]] bool command(const DriveCommand& command);
  /// Moves on to `until`; nothing happens when that is not later than the state.
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
