#pragma once

#include <string>
#include <vector>

#include "common/messages/converted.hpp"
#include "controller/core/controller.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::controller {

/// A pose seen from above; refused when it is not valid or more than 10 km from the origin.
messages::Converted<PlanarPose> to_core(const geometry_msgs::msg::Pose& message);
/// Poses of a path; refused when one of them is.
messages::Converted<std::vector<PlanarPose>> to_core(const nav_msgs::msg::Path& message);
/// Refused when cells, size and resolution do not fit each other, or when the grid is turned.
messages::Converted<Grid> to_core(const nav_msgs::msg::OccupancyGrid& message);
/// Refused when image and camera info do not fit each other.
messages::Converted<DepthView> to_core(const sensor_msgs::msg::Image& depth, const sensor_msgs::msg::CameraInfo& info,
                                       const geometry::Pose& T_base_camera);

bool is_finite(const Velocity& velocity);
geometry_msgs::msg::Twist to_message(const Velocity& velocity);
nav_msgs::msg::Path to_message(const std::vector<PlanarPose>& path, const std_msgs::msg::Header& header);
lapis_msgs::msg::ControllerStatus to_message(const Decision& decision, const std_msgs::msg::Header& header);

}  // namespace lapis::controller
