#pragma once

#include "common/config/schema.hpp"
#include "common/robot/robot_description.hpp"
#include "controller/core/controller.hpp"

namespace lapis::controller {

/// The method's configuration and what the process adds to it.
struct ControllerComponentConfig {
  ControllerConfig method;
  double rate_hz = 20.0;
  double max_stamp_difference_s = 0.016;
  robot::RobotDescription robot;
};

/// The limits of the robot. Its reaction time is the lag of the drives plus the latency of lock-step.
RobotLimits limits_of(const robot::RobotDescription& robot);
/// The configuration, completed with the properties of the robot that the core needs.
ControllerComponentConfig completed(ControllerComponentConfig config);

template <class Field>
void describe(Field& field, LocalMapConfig& c) {
  field("range_m", c.range_m, config::in_range(0.5, 20.0), "of depth; obstacles farther away are not kept [m]");
  field("min_height_m", c.min_height_m, config::in_range(-1.0, 10.0),
        "above base_link: what is lower is driven over [m]");
  field.moved("max_height_m", "robot.obstacle_max_height_m");
  field("memory_s", c.memory_s, config::in_range(0.1, 600.0),
        "what was seen longer ago is forgotten; time without a path does not count while the robot stands [s]");
  field("stride", c.stride, config::in_range(1, 32), "every stride-th pixel of every stride-th row is used");
  field("misses_to_clear", c.misses_to_clear, config::in_range(1, 100),
        "images that must look through an obstacle before it is gone");
  field.moved("passes_to_clear", "controller.local_map.misses_to_clear");
}

template <class Field>
void describe(Field& field, WatchdogConfig& c) {
  field("pose_timeout_s", c.pose_timeout_s, config::in_range(0.05, 60.0),
        "the robot stops when /slam/odometry is older [s]");
  field("camera_timeout_s", c.camera_timeout_s, config::in_range(0.05, 60.0), "or the newest depth image [s]");
  field("map_timeout_s", c.map_timeout_s, config::in_range(0.05, 60.0), "or /semantic_mapper/obstacles [s]");
  field("planner_timeout_s", c.planner_timeout_s, config::in_range(0.05, 60.0),
        "or both /planner/path and /planner/status [s]");
}

template <class Field>
void describe(Field& field, ControllerComponentConfig& c) {
  field("rate_hz", c.rate_hz, config::in_range(10.0, 20.0),
        "of commands by the wall clock; in lock-step each tick [Hz]");
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.1),
        "between pose, depth and camera info of one frame [s]");
  field("fan", c.method.fan);
  field("local_map", c.method.local_map);
  field("watchdog", c.method.watchdog);
  field("look_ahead_m", c.method.look_ahead_m, config::in_range(0.2, 5.0),
        "distance of the point of the path that is headed for [m]");
  field("slow_within_m", c.method.slow_within_m, config::in_range(0.01, 5.0),
        "of an obstacle the robot slows down [m]");
  field("slowest_share", c.method.slowest_share, config::in_range(0.05, 1.0),
        "of robot.max_speed_m_s, beside an obstacle");
  field("goal_tolerance_m", c.method.goal_tolerance_m, config::in_range(0.01, 2.0), "at the path's end [m]");
  field("heading_tolerance_rad", c.method.heading_tolerance_rad, config::in_range(0.01, 3.2),
        "at the path's end [rad]");
  field("patience_s", c.method.patience_s, config::in_range(0.0, 60.0),
        "without a free path before the robot tries to recover [s]");
  field("back_up_m", c.method.back_up_m, config::in_range(0.0, 2.0), "first, where it is known to be free [m]");
  field("back_up_speed_m_s", c.method.back_up_speed_m_s, config::in_range(0.01, 1.0), "[m/s]");
  field("recovery_turn_rad", c.method.recovery_turn_rad, config::in_range(0.0, 3.0), "to look around after that [rad]");
  field("progress_timeout_s", c.method.progress_timeout_s, config::in_range(1.0, 600.0),
        "without moving 0.3 m before the robot backs up, and then reports that it is blocked [s]");
  field("look_around_rad_s", c.method.look_around_rad_s, config::in_range(0.05, 2.0),
        "of a turn on the spot that the planner asks for: slow, or images blur [rad/s]");
  field("weak_turn_rad_s", c.method.weak_turn_rad_s, config::in_range(0.05, 10.0),
        "of any turn, at most, while slam's pose does not come from features [rad/s]");
  field.moved("lost_turn_rate_rad_s", "controller.look_around_rad_s",
              "the planner has the robot look around for its pose (planner.lost_timeout_s)");
}

}  // namespace lapis::controller
