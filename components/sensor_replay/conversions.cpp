#include "sensor_replay/conversions.hpp"

namespace lapis::sensor_replay {

messages::CameraSetUp to_set_up(const CameraFile& file) {
  messages::CameraSetUp cameras{file.mount, file.camera, std::nullopt};
  if (file.depth_camera) cameras.depth = {file.depth_camera->camera.pinhole, file.depth_camera->T_color_depth};
  return cameras;
}

messages::CameraMessages to_messages(const ReplayFrame& frame, const CameraFile& camera,
                                     const messages::CameraFrameIds& ids) {
  messages::CameraFrame seen{frame.stamp, frame.color, nullptr, nullptr, std::nullopt};
  if (frame.depth) seen.depth_mm = &*frame.depth;
  if (frame.label) seen.labels = &*frame.label;
  if (frame.T_world_camera) seen.T_world_base = *frame.T_world_camera * T_base_camera(camera.mount).inverse();
  return messages::to_messages(seen, to_set_up(camera), ids);
}

mapping::LabelList to_label_list(const std::vector<ClassName>& classes) {
  std::vector<std::pair<std::uint16_t, std::string>> names;
  for (const auto& entry : classes) names.emplace_back(entry.id, entry.name);
  return mapping::LabelList::from_names(names);
}

}  // namespace lapis::sensor_replay
