#include "controller/controller_config.hpp"

namespace lapis::controller {
namespace {

constexpr double kSightLatency = 1.0;    // frames until an obstacle is seen
constexpr double kCommandLatency = 1.0;  // frames until a command takes effect

}  // namespace

RobotLimits limits_of(const robot::RobotDescription& robot) {
  return {robot.radius_m,
          robot.max_speed_m_s,
          robot.max_turn_rate_rad_s,
          robot.max_acceleration_m_s2,
          robot.max_turn_acceleration_rad_s2,
          robot.drive_lag_s + (kSightLatency + kCommandLatency) / robot.camera.rate_hz};
}

DriveModel drive_model(const robot::RobotDescription& robot) {
  return {robot.drive_lag_s, robot.max_acceleration_m_s2, robot.max_turn_acceleration_rad_s2,
          time::Duration::from_seconds(kCommandLatency / robot.camera.rate_hz),
          time::Duration::from_seconds(robot.command_timeout_s)};
}

ControllerComponentConfig completed(ControllerComponentConfig config) {
  config.method.local_map.max_height_m = config.robot.obstacle_max_height_m;
  return config;
}

}  // namespace lapis::controller
