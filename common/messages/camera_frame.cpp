#include "common/messages/camera_frame.hpp"

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::messages {
namespace {

geometry_msgs::msg::TransformStamped stamped_transform(const geometry::Pose& T_parent_child, const std::string& parent,
                                                       const std::string& child, time::Time stamp) {
  geometry_msgs::msg::TransformStamped message;
  message.header(header(stamp, parent));
  message.child_frame_id(child);
  message.transform(to_transform(T_parent_child));
  return message;
}

}  // namespace

CameraMessages to_messages(const CameraFrame& frame, const CameraSetUp& cameras, const CameraFrameIds& ids) {
  const auto h = header(frame.stamp, ids.optical);
  const auto of_depth = cameras.depth ? header(frame.stamp, ids.depth_optical) : h;
  CameraMessages out;
  out.color = to_image(frame.color, "rgb8", h);
  out.color_info = to_camera_info({cameras.color, {}}, h);
  out.depth_info = to_camera_info({cameras.depth ? cameras.depth->camera : cameras.color, {}}, of_depth);
  if (frame.depth_mm != nullptr) out.depth = to_image(*frame.depth_mm, "16UC1", of_depth);
  if (frame.labels != nullptr) out.labels = to_label_image(*frame.labels, h);
  if (frame.T_world_base) {
    nav_msgs::msg::Odometry truth;
    truth.header(header(frame.stamp, ids.world));
    truth.child_frame_id(ids.base);
    truth.pose().pose(to_message(*frame.T_world_base));
    out.ground_truth = truth;
  }
  return out;
}

tf2_msgs::msg::TFMessage to_static_transforms(const CameraSetUp& cameras, const CameraFrameIds& ids, time::Time stamp) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(stamped_transform(T_base_link(cameras.mount), ids.base, ids.camera, stamp));
  message.transforms().push_back(stamped_transform(geometry::T_link_optical(), ids.camera, ids.optical, stamp));
  if (cameras.depth) {
    message.transforms().push_back(
        stamped_transform(cameras.depth->T_color_depth, ids.optical, ids.depth_optical, stamp));
  }
  return message;
}

}  // namespace lapis::messages
