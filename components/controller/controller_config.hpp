#pragma once

#include "common/config/schema.hpp"
#include "common/robot/robot_description.hpp"
#include "controller/core/command_odometry.hpp"
#include "controller/core/controller.hpp"

namespace lapis::controller {

/// The method's configuration and what the process adds to it.
struct ControllerComponentConfig {
  ControllerConfig method;
  double rate_hz = 20.0;
  double max_stamp_difference_s = 0.0;
  bool publish_odometry = false;
  robot::RobotDescription robot;
};

/// The limits of the robot. Its reaction time is the lag of the drives plus the latency of lock-step.
RobotLimits limits_of(const robot::RobotDescription& robot);
/// Its drives; a command takes effect one frame of the camera later.
DriveModel drive_model(const robot::RobotDescription& robot);
/// The configuration, completed with the properties of the robot that the core needs.
ControllerComponentConfig completed(ControllerComponentConfig config);

template <class Field>
void describe(Field& field, LocalMapConfig& c) {
  field("range_m", c.range_m, config::in_range(0.5, 20.0),
        "largest depth that is used; points are dropped when they are more than 1 m farther than this from the "
        "robot [m]");
  field("min_height_m", c.min_height_m, config::in_range(-1.0, 10.0),
        "lowest height of points that count as obstacles, above base_link; the robot drives over lower ones [m]");
  field.moved("max_height_m", "robot.obstacle_max_height_m");
  field("memory_s", c.memory_s, config::in_range(0.1, 600.0),
        "time after which a point not seen again is forgotten; standing without a path does not count [s]");
  field("stride", c.stride, config::in_range(1, 32),
        "sampling step of depth images: every stride-th pixel of every stride-th row is used");
  field("misses_to_clear", c.misses_to_clear, config::in_range(1, 100),
        "number of depth images that have to see through a point before it is removed");
  field.moved("passes_to_clear", "controller.local_map.misses_to_clear");
}

template <class Field>
void describe(Field& field, WatchdogConfig& c) {
  field("pose_timeout_s", c.pose_timeout_s, config::in_range(0.05, 60.0),
        "largest age of /slam/odometry; the robot stops when the newest pose is older [s]");
  field("camera_timeout_s", c.camera_timeout_s, config::in_range(0.05, 60.0),
        "largest age of the newest depth image, and of the newest one with a pose; the robot stops when either "
        "is older [s]");
  field("map_timeout_s", c.map_timeout_s, config::in_range(0.05, 60.0),
        "largest age of /semantic_mapper/obstacles; the robot stops when the newest grid is older [s]");
  field("planner_timeout_s", c.planner_timeout_s, config::in_range(0.05, 60.0),
        "largest age of the newest message on /planner/path or /planner/status; the robot stops when both are "
        "older [s]");
}

template <class Field>
void describe(Field& field, ControllerComponentConfig& c) {
  field("rate_hz", c.rate_hz, config::in_range(10.0, 20.0),
        "rate of commands in wall-clock mode; in lock-step there is one command for each tick [Hz]");
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.5),
        "largest difference between the stamps of pose, depth image and camera info of a frame; 0: 0.6 of the camera's "
        "period, at most 0.12 s [s]");
  field("publish_odometry", c.publish_odometry, config::anything(),
        "whether /odom is the motion to which the controller's commands lead: for a robot that measures none "
        "(config/robot_without_odometry)");
  field("fan", c.method.fan);
  field("local_map", c.method.local_map);
  field("watchdog", c.method.watchdog);
  field("look_ahead_m", c.method.look_ahead_m, config::in_range(0.2, 5.0),
        "distance along the planner's path from the robot to the point that the robot heads for [m]",
        config::Change::kAtRunTime);
  field("slow_within_m", c.method.slow_within_m, config::in_range(0.01, 5.0),
        "distance from the robot's disc to an obstacle ahead below which the robot slows down [m]",
        config::Change::kAtRunTime);
  field("slowest_share", c.method.slowest_share, config::in_range(0.05, 1.0),
        "share of robot.max_speed_m_s that is allowed right beside an obstacle ahead; it rises to 1 at "
        "slow_within_m",
        config::Change::kAtRunTime);
  field("goal_tolerance_m", c.method.goal_tolerance_m, config::in_range(0.01, 2.0),
        "largest distance from the path's end at which the robot has arrived and only turns to the final heading "
        "[m]",
        config::Change::kAtRunTime);
  field("heading_tolerance_rad", c.method.heading_tolerance_rad, config::in_range(0.01, 3.2),
        "largest error of the heading at the path's end with which the path is finished [rad]",
        config::Change::kAtRunTime);
  field("patience_s", c.method.patience_s, config::in_range(0.0, 60.0),
        "time without a free path after which the robot tries to recover: it backs up and looks around [s]",
        config::Change::kAtRunTime);
  field("back_up_m", c.method.back_up_m, config::in_range(0.0, 2.0),
        "distance by which the robot backs up to recover, where the space behind it is known to be free [m]",
        config::Change::kAtRunTime);
  field("back_up_speed_m_s", c.method.back_up_speed_m_s, config::in_range(0.01, 1.0),
        "largest speed at which the robot backs up to recover [m/s]", config::Change::kAtRunTime);
  field("recovery_turn_rad", c.method.recovery_turn_rad, config::in_range(0.0, 3.0),
        "angle by which the robot turns to look around when there is no free path, after backing up [rad]",
        config::Change::kAtRunTime);
  field("progress_timeout_s", c.method.progress_timeout_s, config::in_range(1.0, 600.0),
        "time without moving 0.3 m after which the robot backs up; if it cannot, or if that fails, it reports "
        "that it is blocked [s]",
        config::Change::kAtRunTime);
  field("look_around_rad_s", c.method.look_around_rad_s, config::in_range(0.05, 2.0),
        "rate of a turn on the spot that the planner asks for; slow, because fast turns blur images [rad/s]",
        config::Change::kAtRunTime);
  field("weak_turn_rad_s", c.method.weak_turn_rad_s, config::in_range(0.05, 10.0),
        "largest rate of any turn while slam's pose does not come from features [rad/s]", config::Change::kAtRunTime);
  field("speed_limit_m_s", c.method.speed_limit_m_s, config::in_range(0.01, 5.0),
        "largest speed that is commanded, also where robot.max_speed_m_s is higher [m/s]", config::Change::kAtRunTime);
  field("turn_limit_rad_s", c.method.turn_limit_rad_s, config::in_range(0.05, 10.0),
        "largest rate of turns that is commanded, also where robot.max_turn_rate_rad_s is higher [rad/s]",
        config::Change::kAtRunTime);
  field.moved("lost_turn_rate_rad_s", "controller.look_around_rad_s",
              "the planner has the robot look around for its pose (planner.lost_timeout_s)");
}

}  // namespace lapis::controller
