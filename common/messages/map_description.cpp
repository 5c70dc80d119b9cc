#include "common/messages/map_description.hpp"

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lapis::messages {
namespace {

/// A number that does not fit becomes -1, which validation refuses.
int to_int(std::uint32_t number) {
  return number > static_cast<std::uint32_t>(std::numeric_limits<int>::max()) ? -1 : static_cast<int>(number);
}

mapping::SensorModel to_sensor_model(const lapis_msgs::msg::MapSensorModel& message) {
  mapping::SensorModel model;
  model.fusion = message.fusion();
  model.hit_gain = message.hit_gain();
  model.miss_gain = message.miss_gain();
  model.label_accuracy = message.label_accuracy();
  model.prior_occupied = message.prior_occupied();
  model.prior_votes = message.prior_votes();
  model.occupancy_limit = message.occupancy_limit();
  model.share_limit = message.share_limit();
  model.use_paper_increments = message.use_paper_increments();
  model.class_count = to_int(message.class_count());
  model.class_priors = message.class_priors();
  return model;
}

lapis_msgs::msg::MapSensorModel to_message(const mapping::SensorModel& model) {
  lapis_msgs::msg::MapSensorModel message;
  message.fusion(model.fusion);
  message.hit_gain(model.hit_gain);
  message.miss_gain(model.miss_gain);
  message.label_accuracy(model.label_accuracy);
  message.prior_occupied(model.prior_occupied);
  message.prior_votes(model.prior_votes);
  message.occupancy_limit(model.occupancy_limit);
  message.share_limit(model.share_limit);
  message.use_paper_increments(model.use_paper_increments);
  message.class_count(static_cast<std::uint32_t>(model.class_count));
  message.class_priors(model.class_priors);
  return message;
}

mapping::FrameSettings to_frame_settings(const lapis_msgs::msg::MapFrameSettings& message) {
  mapping::FrameSettings frames;
  frames.stride = to_int(message.stride());
  frames.integration.min_range_m = message.min_range_m();
  frames.integration.max_range_m = message.max_range_m();
  frames.integration.min_height_m = message.min_height_m();
  frames.integration.max_height_m = message.max_height_m();
  frames.integration.end_margin_voxels = message.end_margin_voxels();
  frames.integration.depth_noise_per_m = message.depth_noise_per_m();
  frames.integration.kernel_length_voxels = message.kernel_length_voxels();
  return frames;
}

lapis_msgs::msg::MapFrameSettings to_message(const mapping::FrameSettings& frames) {
  lapis_msgs::msg::MapFrameSettings message;
  message.stride(static_cast<std::uint32_t>(frames.stride));
  message.min_range_m(frames.integration.min_range_m);
  message.max_range_m(frames.integration.max_range_m);
  message.min_height_m(frames.integration.min_height_m);
  message.max_height_m(frames.integration.max_height_m);
  message.end_margin_voxels(frames.integration.end_margin_voxels);
  message.depth_noise_per_m(frames.integration.depth_noise_per_m);
  message.kernel_length_voxels(frames.integration.kernel_length_voxels);
  return message;
}

/// Throws std::runtime_error when an id is 0 or occurs twice.
mapping::LabelList to_labels(const std::vector<lapis_msgs::msg::MapLabel>& message) {
  std::vector<mapping::Label> labels;
  for (const auto& label : message)
    labels.push_back({label.id(), label.name(), {label.red(), label.green(), label.blue()}});
  return mapping::LabelList(std::move(labels));
}

lapis_msgs::msg::MapLabel to_message(const mapping::Label& label) {
  lapis_msgs::msg::MapLabel message;
  message.id(label.id);
  message.name(label.name);
  message.red(label.color.r);
  message.green(label.color.g);
  message.blue(label.color.b);
  return message;
}

}  // namespace

Converted<mapping::MapDescription> from_message(const lapis_msgs::msg::MapDescription& message) {
  mapping::MapDescription description;
  description.resolution_m = message.resolution_m();
  description.frames = to_frame_settings(message.frames());
  description.sensor_model = to_sensor_model(message.sensor_model());
  description.epoch = message.epoch();
  description.session = message.session();
  try {
    description.labels = to_labels(message.labels());
    mapping::validate(description);
    return description;
  } catch (const std::runtime_error& error) {
    return Converted<mapping::MapDescription>::refused(error.what());
  }
}

lapis_msgs::msg::MapDescription to_message(const mapping::MapDescription& description,
                                           const std_msgs::msg::Header& header) {
  lapis_msgs::msg::MapDescription message;
  message.header(header);
  message.epoch(description.epoch);
  message.session(description.session);
  message.resolution_m(description.resolution_m);
  message.frames(to_message(description.frames));
  message.sensor_model(to_message(description.sensor_model));
  for (const auto& label : description.labels.labels()) message.labels().push_back(to_message(label));
  return message;
}

}  // namespace lapis::messages
