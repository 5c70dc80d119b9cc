#include "slam/conversions.hpp"

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::slam {

using messages::stamped_transform;

lapis_msgs::msg::TrackedFrame to_tracked_frame(const TrackingResult& result, const FrameContext& context,
                                               const FrameIds& ids) {
  lapis_msgs::msg::TrackedFrame message;
  message.header(messages::header(context.stamp, context.optical_frame));
  message.map_frame_id(ids.map);
  message.session(context.session);
  message.state(static_cast<std::uint8_t>(result.state));
  message.source(static_cast<std::uint8_t>(result.source));
  message.reason(result.reason);
  message.graph_version(result.graph_version);
  if (!has_pose(result) && result.state != TrackingState::kUnconnected) return message;
  message.is_keyframe(result.is_keyframe);
  message.keyframe_id(result.keyframe_id);
  if (has_pose(result)) message.keyframe_pose(messages::to_message(result.T_map_keyframe));
  message.pose_in_keyframe(messages::to_message(result.T_keyframe_camera));
  message.covariance(messages::to_row_major(result.covariance));
  message.drift_m(result.drift_m);
  message.drift_rad(result.drift_rad);
  return message;
}

nav_msgs::msg::Odometry to_odometry(const TrackingResult& result, const FrameContext& context, const FrameIds& ids) {
  const geometry::Pose T_map_base = result.T_map_keyframe * result.T_keyframe_camera * context.T_base_camera.inverse();
  // T_map_camera exp(xi) = T_map_base exp(Ad(T_base_camera) xi) T_base_camera; then to axes parallel to the map.
  geometry::Matrix6d J = geometry::Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = T_map_base.linear();
  J.bottomRightCorner<3, 3>() = T_map_base.linear();
  J *= geometry::adjoint(context.T_base_camera);
  nav_msgs::msg::Odometry message;
  message.header(messages::header(context.stamp, ids.map));
  message.child_frame_id(ids.base);
  message.pose().pose(messages::to_message(T_map_base));
  message.pose().covariance(messages::to_row_major(J * result.map_covariance * J.transpose()));
  return message;
}

void set_twist(const geometry::Pose& T_previous_base, time::Duration elapsed, nav_msgs::msg::Odometry& odometry) {
  const geometry::Vector6d twist = geometry::se3_log(T_previous_base) / elapsed.seconds();
  auto& linear = odometry.twist().twist().linear();
  auto& angular = odometry.twist().twist().angular();
  linear.x(twist[0]);
  linear.y(twist[1]);
  linear.z(twist[2]);
  angular.x(twist[3]);
  angular.y(twist[4]);
  angular.z(twist[5]);
}

tf2_msgs::msg::TFMessage to_transforms(const nav_msgs::msg::Odometry& odometry, const FrameIds& ids) {
  std_msgs::msg::Header in_odom = odometry.header();
  in_odom.frame_id(ids.odom);
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(stamped_transform(odometry.header(), ids.odom, geometry::Pose::Identity()));
  if (const auto T_map_base = messages::from_message(odometry.pose().pose())) {
    message.transforms().push_back(stamped_transform(in_odom, ids.base, *T_map_base));
  }
  return message;
}

tf2_msgs::msg::TFMessage to_correction(const nav_msgs::msg::Odometry& odometry, const geometry::Pose& T_odom_base,
                                       const FrameIds& ids) {
  tf2_msgs::msg::TFMessage message;
  if (const auto T_map_base = messages::from_message(odometry.pose().pose())) {
    message.transforms().push_back(stamped_transform(odometry.header(), ids.odom, *T_map_base * T_odom_base.inverse()));
  }
  return message;
}

lapis_msgs::msg::PoseGraph to_message(const PoseGraphSnapshot& graph, const FrameContext& context,
                                      const FrameIds& ids) {
  lapis_msgs::msg::PoseGraph message;
  message.header(messages::header(context.stamp, ids.map));
  message.session(context.session);
  message.version(graph.version);
  for (const auto& node : graph.nodes) {
    lapis_msgs::msg::PoseGraphNode item;
    item.id(node.id);
    item.stamp(messages::to_message(node.stamp));
    item.pose(messages::to_message(node.T_map_camera));
    item.is_drifting(node.is_drifting);
    message.nodes().push_back(item);
  }
  for (const auto& edge : graph.edges) {
    lapis_msgs::msg::PoseGraphEdge item;
    item.from_id(edge.from);
    item.to_id(edge.to);
    item.type(static_cast<std::uint8_t>(edge.type));
    item.relative_pose(messages::to_message(edge.T_from_to));
    std::size_t at = 0;
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) item.information()[at++] = edge.information(row, column);
    }
    message.edges().push_back(item);
  }
  return message;
}

nav_msgs::msg::Path to_path(const PoseGraphSnapshot& graph, const FrameContext& context, const FrameIds& ids) {
  nav_msgs::msg::Path message;
  message.header(messages::header(context.stamp, ids.map));
  const geometry::Pose T_camera_base = context.T_base_camera.inverse();
  for (const auto& node : graph.nodes) {
    geometry_msgs::msg::PoseStamped pose;
    pose.header(messages::header(node.stamp, ids.map));
    pose.pose(messages::to_message(node.T_map_camera * T_camera_base));
    message.poses().push_back(pose);
  }
  return message;
}

}  // namespace lapis::slam
