#include "sensor_replay/conversions.hpp"

#include <algorithm>
#include <cstring>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::sensor_replay {
namespace {

std_msgs::msg::Header header(time::Time stamp, const std::string& frame_id) {
  std_msgs::msg::Header h;
  h.stamp(messages::to_message(stamp));
  h.frame_id(frame_id);
  return h;
}

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

// mono8 where all ids fit: 255 would read as "unlabelled" (vision_msgs).
sensor_msgs::msg::Image label_message(const geometry::LabelImage& labels, const std_msgs::msg::Header& h) {
  const bool fits = std::all_of(labels.pixels.begin(), labels.pixels.end(), [](auto id) { return id < 255; });
  if (!fits) return image_message(labels, "mono16", h);
  geometry::Image<std::uint8_t> narrow(labels.width, labels.height);
  std::transform(labels.pixels.begin(), labels.pixels.end(), narrow.pixels.begin(),
                 [](auto id) { return static_cast<std::uint8_t>(id); });
  return image_message(narrow, "mono8", h);
}

sensor_msgs::msg::CameraInfo info_message(const CameraFile& file, const std_msgs::msg::Header& h) {
  const auto& c = file.camera;
  sensor_msgs::msg::CameraInfo info;
  info.header(h);
  info.width(static_cast<std::uint32_t>(c.width));
  info.height(static_cast<std::uint32_t>(c.height));
  info.distortion_model("plumb_bob");
  info.d(std::vector<double>(file.distortion.size(), 0.0));  // the images are rectified
  info.k({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
  return info;
}

geometry_msgs::msg::TransformStamped stamped_transform(const geometry::Pose& T_parent_child, const std::string& parent,
                                                       const std::string& child, time::Time stamp) {
  geometry_msgs::msg::TransformStamped message;
  message.header(header(stamp, parent));
  message.child_frame_id(child);
  message.transform(messages::to_transform(T_parent_child));
  return message;
}

}  // namespace

FrameMessages to_messages(const ReplayFrame& frame, const CameraFile& camera, const FrameIds& ids) {
  const auto h = header(frame.stamp, ids.optical);
  FrameMessages out;
  out.color = image_message(frame.color, "rgb8", h);
  out.info = info_message(camera, h);
  if (frame.depth) out.depth = image_message(*frame.depth, "16UC1", h);
  if (frame.label) out.labels = label_message(*frame.label, h);
  if (frame.T_world_camera) {
    nav_msgs::msg::Odometry truth;
    truth.header(header(frame.stamp, ids.world));
    truth.child_frame_id(ids.base);
    truth.pose().pose(messages::to_message(*frame.T_world_camera * T_base_camera(camera.mount).inverse()));
    out.ground_truth = truth;
  }
  return out;
}

tf2_msgs::msg::TFMessage to_static_transforms(const CameraMount& mount, const FrameIds& ids, time::Time stamp) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(stamped_transform(T_base_link(mount), ids.base, ids.camera, stamp));
  message.transforms().push_back(stamped_transform(T_link_optical(), ids.camera, ids.optical, stamp));
  return message;
}

vision_msgs::msg::LabelInfo to_message(const std::vector<ClassName>& classes, const FrameIds& ids, time::Time stamp) {
  vision_msgs::msg::LabelInfo message;
  message.header(header(stamp, ids.optical));
  for (const auto& entry : classes) {
    vision_msgs::msg::VisionClass item;
    item.class_id(entry.id);
    item.class_name(entry.name);
    message.class_map().push_back(item);
  }
  return message;
}

}  // namespace lapis::sensor_replay
