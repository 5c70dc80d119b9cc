#pragma once

#include <string>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "simulator/core/world.hpp"

namespace lapis::simulator {

/// Place and heading of a view.
struct ViewPoint {
  std::string name;  ///< room and number: "kitchen_1"
  Eigen::Vector2d position{0, 0};
  double yaw_rad = 0.0;
};

/// Chooses `per_room` views in each room that show much of it: those with the most in sight among a fixed set of
/// candidates where the robot can stand. A scene without rooms counts as one room. The choice is deterministic.
std::vector<ViewPoint> choose_views(const World& world, const geometry::PinholeCamera& camera,
                                    const geometry::CameraMount& mount, double robot_radius_m, int per_room);

/// Pose of the camera of a robot that stands at `position` [m] with this yaw.
geometry::Pose T_world_camera(const World& world, const geometry::CameraMount& mount, const Eigen::Vector2d& position,
                              double yaw_rad);

}  // namespace lapis::simulator
