#include "sensor_replay/tum_recording.hpp"

#include <stdexcept>

#include "sensor_replay/camera_yaml.hpp"
#include "sensor_replay/core/dataset_summary.hpp"

namespace lapis::sensor_replay {
namespace {

TumDatasetConfig dataset_config(const SensorReplayConfig& config) {
  return {config.dataset, config.class_list, config.max_stamp_difference_s, config.labels};
}

FrameRange selected(const TumDataset& dataset, const SensorReplayConfig& config) {
  std::optional<time::Duration> duration;
  if (config.duration_s > 0.0) duration = time::Duration::from_seconds(config.duration_s);
  return dataset.select(time::Duration::from_seconds(config.start_s), duration);
}

}  // namespace

TumRecording::TumRecording(const SensorReplayConfig& config, runtime::Context& context)
    : context_(context), dataset_(dataset_config(config), read_camera_file), range_(selected(dataset_, config)),
      frames_([this](std::size_t index) { return dataset_.load_frame(index); }, range_),
      camera_(context, {dataset_.has_labels(), dataset_.has_ground_truth()}, config.rate > 0.0), next_(range_.begin) {
  const auto labels = dataset_.has_labels() ? to_label_list(dataset_.classes()) : mapping::LabelList();
  camera_.publish_latched(to_set_up(dataset_.camera()), labels, dataset_.stamp(range_.begin));
}

std::string TumRecording::describe(const SensorReplayConfig& config) {
  return sensor_replay::describe(TumDataset(dataset_config(config), read_camera_file));
}

double TumRecording::length_s() const {
  return (dataset_.stamp(range_.end - 1) - dataset_.stamp(range_.begin)).seconds();
}

std::optional<time::Time> TumRecording::next_stamp() {
  return next_ < range_.end ? std::optional(dataset_.stamp(next_)) : std::nullopt;
}

/// A frame without a usable colour image is skipped.
Recording::Step TumRecording::publish_next() {
  const auto loaded = frames_.next();
  if (!loaded) return Step::kEnd;
  ++next_;
  if (const auto* skipped = std::get_if<SkippedFrame>(&*loaded)) {
    count(*skipped);
    return Step::kSkipped;
  }
  const auto& frame = std::get<ReplayFrame>(*loaded);
  for (const auto& problem : frame.problems) count(problem);
  stamp_ = frame.stamp;
  last_ = to_messages(frame, dataset_.camera(), camera_.ids());
  camera_.publish(*last_);
  return Step::kPublished;
}

void TumRecording::publish_again() {
  if (last_) camera_.publish(*last_);
}

void TumRecording::count(const SkippedFrame& skipped) {
  context_.status().count("frames skipped: " + to_string(skipped.problem.fault));
  spdlog::warn("frame {} skipped: {}", skipped.index, to_string(skipped.problem));
}

void TumRecording::count(const ImageProblem& problem) {
  const std::string kind = problem.part == ImagePart::kDepth ? "depth" : "label";
  const std::string key = kind + " images unusable: " + to_string(problem.fault);
  context_.status().count(key);
  if (context_.rate_limit().pass(key)) spdlog::warn("{} image not published: {}", kind, to_string(problem));
}

}  // namespace lapis::sensor_replay
