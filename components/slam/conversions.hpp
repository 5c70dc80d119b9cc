#pragma once

#include <string>

#include "common/geometry/se3.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/tf2_msgs.hpp"
#include "slam/core/rgbd_slam.hpp"

namespace lapis::slam {

/// Frame ids as they are published, with the robot's namespace.
struct FrameIds {
  std::string map;
  std::string odom;
  std::string base;
};

/// Time, frame, session and camera mount of a result.
struct FrameContext {
  time::Time stamp;
  std::string optical_frame;
  std::int64_t session = 0;
  geometry::Pose T_base_camera = geometry::Pose::Identity();
};

lapis_msgs::msg::TrackedFrame to_tracked_frame(const TrackingResult& result, const FrameContext& context,
                                               const FrameIds& ids);
/// Pose of base_link in the map, without a twist. As ROS defines it, the axes of the covariance are parallel to the
/// map.
nav_msgs::msg::Odometry to_odometry(const TrackingResult& result, const FrameContext& context, const FrameIds& ids);
/// Sets the twist to the mean velocity of base_link over `elapsed`, in base_link [m/s, rad/s].
void set_twist(const geometry::Pose& T_previous_base, time::Duration elapsed, nav_msgs::msg::Odometry& odometry);
/// Where slam publishes odom -> base_link: that transform, and map -> odom as the identity.
tf2_msgs::msg::TFMessage to_transforms(const nav_msgs::msg::Odometry& odometry, const FrameIds& ids);
/// Where wheel odometry publishes odom -> base_link: map -> odom alone, so that both together give slam's pose.
tf2_msgs::msg::TFMessage to_correction(const nav_msgs::msg::Odometry& odometry, const geometry::Pose& T_odom_base,
                                       const FrameIds& ids);
lapis_msgs::msg::PoseGraph to_message(const PoseGraphSnapshot& graph, const FrameContext& context, const FrameIds& ids);
/// Key-frame trajectory of base_link.
nav_msgs::msg::Path to_path(const PoseGraphSnapshot& graph, const FrameContext& context, const FrameIds& ids);

}  // namespace lapis::slam
