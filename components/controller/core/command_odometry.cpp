#include "controller/core/command_odometry.hpp"

#include <algorithm>

#include "common/robot/drive_response.hpp"
#include "common/time/stamp_buffer.hpp"

namespace lapis::controller {
namespace {

constexpr double kStep_s = 0.005;          // arcs this short are straight enough
constexpr double kLongestBraking_s = 5.0;  // after it the robot stands, however long there are no commands

}  // namespace

void CommandOdometry::add(const Velocity& command, time::Time now) {
  const time::Time until = now + model_.latency;
  if (command_ && until > stamp_) {
    const double elapsed_s = (until - stamp_).seconds();
    const double driven_s = std::min(elapsed_s, model_.command_timeout.seconds());
    advance(driven_s, *command_);
    advance(std::min(elapsed_s - driven_s, kLongestBraking_s), {});
  }
  command_ = command;
  if (until > stamp_ || stamp_ - until > time::kRestartGap) stamp_ = until;
}

void CommandOdometry::advance(double elapsed_s, const Velocity& target) {
  for (double left_s = elapsed_s; left_s > 0.0; left_s -= kStep_s) {
    const double step_s = std::min(left_s, kStep_s);
    const auto forward = robot::drive_response(velocity_.forward_m_s, target.forward_m_s, step_s, model_.lag_s,
                                               model_.max_acceleration_m_s2);
    const auto turn = robot::drive_response(velocity_.turn_rad_s, target.turn_rad_s, step_s, model_.lag_s,
                                            model_.max_turn_acceleration_rad_s2);
    velocity_ = {forward.value, turn.value};
    const PlanarPose half_turn = planar_pose({0.0, 0.0}, 0.5 * turn.integral);
    T_odom_base_ = T_odom_base_ * half_turn * planar_pose({forward.integral, 0.0}, 0.0) * half_turn;
  }
}

}  // namespace lapis::controller
