#include "controller/controller_config.hpp"

namespace lapis::controller {
namespace {

constexpr double kTickLatencies = 2.0;  // frames: one until an obstacle is seen, and one until the command takes effect

}  // namespace

RobotLimits limits_of(const robot::RobotDescription& robot) {
  return {robot.radius_m,
          robot.max_speed_m_s,
          robot.max_turn_rate_rad_s,
          robot.max_acceleration_m_s2,
          robot.max_turn_acceleration_rad_s2,
          robot.drive_lag_s + kTickLatencies / robot.camera.rate_hz};
}

ControllerComponentConfig completed(ControllerComponentConfig config) {
  config.method.local_map.max_height_m = config.robot.obstacle_max_height_m;
  return config;
}

}  // namespace lapis::controller
