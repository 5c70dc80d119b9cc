#include "common/messages/camera_frame.hpp"

#include <algorithm>
#include <cstring>

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::messages {
namespace {

template <class Pixel>
sensor_msgs::msg::Image image_message(const geometry::Image<Pixel>& image, const std::string& encoding,
                                      const std_msgs::msg::Header& h) {
  sensor_msgs::msg::Image message;
  message.header(h);
  message.width(static_cast<std::uint32_t>(image.width));
  message.height(static_cast<std::uint32_t>(image.height));
  message.encoding(encoding);
  message.is_bigendian(0);
  message.step(static_cast<std::uint32_t>(static_cast<std::size_t>(image.width) * sizeof(Pixel)));
  message.data().resize(image.pixels.size() * sizeof(Pixel));
  std::memcpy(message.data().data(), image.pixels.data(), message.data().size());
  return message;
}

// mono8 if all ids are below 255, which would mean "unlabelled" (vision_msgs); otherwise mono16.
sensor_msgs::msg::Image label_message(const geometry::LabelImage& labels, const std_msgs::msg::Header& h) {
  const bool fits = std::all_of(labels.pixels.begin(), labels.pixels.end(), [](auto id) { return id < 255; });
  if (!fits) return image_message(labels, "mono16", h);
  geometry::Image<std::uint8_t> narrow(labels.width, labels.height);
  std::transform(labels.pixels.begin(), labels.pixels.end(), narrow.pixels.begin(),
                 [](auto id) { return static_cast<std::uint8_t>(id); });
  return image_message(narrow, "mono8", h);
}

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
  out.color = image_message(frame.color, "rgb8", h);
  out.color_info = to_camera_info({cameras.color, {}}, h);
  out.depth_info = to_camera_info({cameras.depth ? cameras.depth->camera : cameras.color, {}}, of_depth);
  if (frame.depth_mm != nullptr) out.depth = image_message(*frame.depth_mm, "16UC1", of_depth);
  if (frame.labels != nullptr) out.labels = label_message(*frame.labels, h);
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
