#pragma once

#include <string>

#include "common/geometry/se3.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/tf2_msgs.hpp"
#include "slam/core/rgbd_slam.hpp"

namespace lapis::slam {

/// Frame ids as they go on the wire, with the robot's namespace.
struct FrameIds {
  std::string map;
  std::string odom;
  std::string base;
};

/// Where and when a result belongs.
struct FrameContext {
  time::Time stamp;
  std::string optical_frame;
  std::int64_t session = 0;
  geometry::Pose T_base_camera = geometry::Pose::Identity();
};

lapis_msgs::msg::TrackedFrame to_tracked_frame(const TrackingResult& result, const FrameContext& context,
                                               const FrameIds& ids);
/// Pose of base_link in the map; ROS's covariance has its axes parallel to the map. The twist is the mean motion since
/// `previous`, in base_link, when that is known.
nav_msgs::msg::Odometry to_odometry(const TrackingResult& result, const FrameContext& context, const FrameIds& ids);
void set_twist(const geometry::Pose& T_previous_base, time::Duration elapsed, nav_msgs::msg::Odometry& odometry);
/// Where slam is the one who says odom -> base_link: that, and map -> odom as identity.
tf2_msgs::msg::TFMessage to_transforms(const nav_msgs::msg::Odometry& odometry, const FrameIds& ids);
/// Where wheel odometry says odom -> base_link: map -> odom alone, so that both together are slam's pose.
tf2_msgs::msg::TFMessage to_correction(const nav_msgs::msg::Odometry& odometry, const geometry::Pose& T_odom_base,
                                       const FrameIds& ids);
lapis_msgs::msg::PoseGraph to_message(const PoseGraphSnapshot& graph, const FrameContext& context, const FrameIds& ids);
/// Key-frame trajectory of base_link.
nav_msgs::msg::Path to_path(const PoseGraphSnapshot& graph, const FrameContext& context, const FrameIds& ids);

}  // namespace lapis::slam
