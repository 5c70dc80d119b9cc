#pragma once

#include "common/mapping/model/label_list.hpp"
#include "common/messages/camera_frame.hpp"
#include "sensor_replay/core/tum_dataset.hpp"

namespace lapis::sensor_replay {

messages::CameraSetUp to_set_up(const CameraFile& file);
messages::CameraMessages to_messages(const ReplayFrame& frame, const CameraFile& camera,
                                     const messages::CameraFrameIds& ids);
mapping::LabelList to_label_list(const std::vector<ClassName>& classes);

}  // namespace lapis::sensor_replay
