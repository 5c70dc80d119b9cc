#pragma once

#include "common/config/schema.hpp"
#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::robot {

/// The camera and its mounting.
struct CameraDescription {
  int width = 640;
  int height = 360;
  double horizontal_fov_deg = 90.0;
  double vertical_fov_deg = 58.7155;  ///< square pixels: 2 atan(height / width tan(horizontal / 2))
  double rate_hz = 15.0;
  double height_m = 1.0;
  double pitch_down_deg = 0.0;
};

/// Properties of the robot that several processes need; only config/robot.yaml sets them.
struct RobotDescription {
  double radius_m = 0.20;
  double max_speed_m_s = 0.6;
  double max_turn_rate_rad_s = 0.8;
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  double drive_lag_s = 0.15;
  double command_timeout_s = 0.2;
  double sensing_range_m = 5.0;
  double obstacle_min_height_m = 0.2;
  double obstacle_max_height_m = 1.2;
  CameraDescription camera;
};

/// Pinhole model whose principal point is the middle of the image.
geometry::PinholeCamera pinhole_camera(const CameraDescription& camera);
geometry::CameraMount camera_mount(const CameraDescription& camera);

template <class Field>
void describe(Field& field, CameraDescription& c) {
  field("width", c.width, config::in_range(16, 4096), "width of the image [px]");
  field("height", c.height, config::in_range(16, 4096), "height of the image [px]");
  field("horizontal_fov_deg", c.horizontal_fov_deg, config::in_range(10.0, 170.0), "horizontal field of view [deg]");
  field("vertical_fov_deg", c.vertical_fov_deg, config::in_range(10.0, 170.0), "vertical field of view [deg]");
  field("rate_hz", c.rate_hz, config::in_range(0.1, 120.0), "frame rate of the camera [Hz]");
  field("height_m", c.height_m, config::in_range(0.0, 10.0), "height of the camera above base_link [m]");
  field("pitch_down_deg", c.pitch_down_deg, config::in_range(-90.0, 90.0),
        "downward tilt of the camera; positive: it looks towards the floor [deg]");
}

template <class Field>
void describe(Field& field, RobotDescription& c) {
  field("radius_m", c.radius_m, config::in_range(0.05, 2.0), "radius of the disc that the robot fills [m]");
  field("max_speed_m_s", c.max_speed_m_s, config::in_range(0.01, 5.0), "largest speed, forwards and backwards [m/s]");
  field("max_turn_rate_rad_s", c.max_turn_rate_rad_s, config::in_range(0.01, 10.0),
        "largest turn rate, to either side [rad/s]");
  field("max_acceleration_m_s2", c.max_acceleration_m_s2, config::in_range(0.01, 50.0),
        "largest acceleration along the robot's heading [m/s2]");
  field("max_turn_acceleration_rad_s2", c.max_turn_acceleration_rad_s2, config::in_range(0.01, 100.0),
        "largest angular acceleration [rad/s2]");
  field("drive_lag_s", c.drive_lag_s, config::in_range(0.001, 5.0),
        "time constant with which the drives follow a command [s]");
  field("command_timeout_s", c.command_timeout_s, config::in_range(0.05, 60.0),
        "time without a message on /cmd_vel after which the robot stops by itself [s]");
  field("sensing_range_m", c.sensing_range_m, config::in_range(0.5, 20.0),
        "sensing range (Euclidean) for map, information and explorable volume alike; returns from beyond it mark "
        "free space up to it [m]");
  field("obstacle_min_height_m", c.obstacle_min_height_m, config::in_range(-100.0, 100.0),
        "lowest height of voxels that are obstacles; those whose centre is lower are floor to the robot; z of "
        "the map frame [m]");
  field("obstacle_max_height_m", c.obstacle_max_height_m, config::in_range(-100.0, 100.0),
        "height from which on nothing is an obstacle, because the robot passes under it; z of the map frame, in "
        "the local map above base_link [m]");
  field("camera", c.camera);
}

}  // namespace lapis::robot
