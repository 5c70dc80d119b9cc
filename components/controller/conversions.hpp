#pragma once

#include <string>
#include <vector>

#include "common/images/rectifier.hpp"
#include "common/messages/converted.hpp"
#include "controller/core/command_odometry.hpp"
#include "controller/core/controller.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::controller {

/// Position and yaw of a pose; refused when the pose is not valid or more than 10 km from the origin.
messages::Converted<PlanarPose> to_core(const geometry_msgs::msg::Pose& message);
/// Poses of a path; refused when one of them is refused.
messages::Converted<std::vector<PlanarPose>> to_core(const nav_msgs::msg::Path& message);
/// Refused when the number of cells differs from the size, the resolution is out of range, or the grid is rotated.
messages::Converted<Grid> to_core(const nav_msgs::msg::OccupancyGrid& message);
/// What the depth camera sees, rectified. Refused when the image or the camera info is not usable, or when their sizes
/// differ.
messages::Converted<DepthView> to_core(const sensor_msgs::msg::Image& depth, const sensor_msgs::msg::CameraInfo& info,
                                       const geometry::Pose& T_base_camera, images::KeptRectifier& rectifier);

/// The motion of a robot with two driven wheels: forwards, and about the vertical axis. Refused when it is not finite.
messages::Converted<Velocity> to_core(const geometry_msgs::msg::Twist& message);
bool is_finite(const Velocity& velocity);
geometry_msgs::msg::Twist to_message(const Velocity& velocity);
nav_msgs::msg::Path to_message(const std::vector<PlanarPose>& path, const std_msgs::msg::Header& header);
/// The pose's covariance is not known, and stays zero.
nav_msgs::msg::Odometry to_message(const CommandOdometry& odometry, const std_msgs::msg::Header& header,
                                   const std::string& base_frame);
lapis_msgs::msg::ControllerStatus to_message(const Decision& decision, const std_msgs::msg::Header& header);

}  // namespace lapis::controller
