#include "common/mapping/file/map_description.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "common/mapping/model/voxel_map.hpp"

namespace lapis::mapping {
namespace {

void refuse_unless(bool is_good, const std::string& what) {
  if (!is_good) throw std::runtime_error(what);
}

/// Remembers the first of several differences.
class Comparison {
 public:
  template <class Value>
  void operator()(const char* name, const Value& a, const Value& b) {
    if (!text_.empty() || a == b) return;
    std::ostringstream out;
    out << name << ' ' << a << " and " << b;
    text_ = out.str();
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void compare(Comparison& compared, const FrameSettings& a, const FrameSettings& b) {
  compared("frame.stride", a.stride, b.stride);
  const IntegrationConfig &one = a.integration, &other = b.integration;
  compared("min_range_m", one.min_range_m, other.min_range_m);
  compared("max_range_m", one.max_range_m, other.max_range_m);
  compared("min_height_m", one.min_height_m, other.min_height_m);
  compared("max_height_m", one.max_height_m, other.max_height_m);
  compared("end_margin_voxels", one.end_margin_voxels, other.end_margin_voxels);
  compared("depth_noise_per_m", one.depth_noise_per_m, other.depth_noise_per_m);
}

void compare(Comparison& compared, const SensorModel& a, const SensorModel& b) {
  compared("fusion", a.fusion, b.fusion);
  compared("hit_gain", a.hit_gain, b.hit_gain);
  compared("miss_gain", a.miss_gain, b.miss_gain);
  compared("label_accuracy", a.label_accuracy, b.label_accuracy);
  compared("prior_occupied", a.prior_occupied, b.prior_occupied);
  compared("prior_votes", a.prior_votes, b.prior_votes);
  compared("use_paper_increments", a.use_paper_increments, b.use_paper_increments);
  compared("occupancy_limit", a.occupancy_limit, b.occupancy_limit);
  compared("share_limit", a.share_limit, b.share_limit);
}

}  // namespace

SensorModel with_classes(SensorModel model, const LabelList& labels) {
  if (labels.max_id() > 1) model.class_count = labels.max_id();
  return model;
}

void validate(const FrameSettings& frames, double resolution_m) {
  const IntegrationConfig& integration = frames.integration;
  validate(integration);
  config::check("frame", CompactFrameConfig{frames.stride});
  refuse_unless(resolution_m >= kMinResolution_m && resolution_m <= kMaxResolution_m,
                "resolution_m must be in [0.02, 0.5]");
  refuse_unless(integration.max_range_m / resolution_m <= kMaxRangeInVoxels, "max_range_m exceeds 500 voxels");
}

void validate(const MapDescription& description) {
  validate(description.frames, description.resolution_m);
  const SensorModel& model = description.sensor_model;
  refuse_unless(std::isfinite(model.occupancy_limit) && std::isfinite(model.share_limit),
                "sensor_model: limits must be finite");
  static_cast<void>(BeliefReader(model));  // throws for a model with which counts cannot be read
  refuse_unless(with_classes(model, description.labels) == model,
                "sensor_model: class_count must be the largest id of the labels");
}

std::string difference(const FrameSettings& a, const FrameSettings& b) {
  Comparison compared;
  compare(compared, a, b);
  return compared.text();
}

std::string difference(const MapDescription& a, const MapDescription& b) {
  Comparison compared;
  compared("resolution_m", a.resolution_m, b.resolution_m);
  compare(compared, a.frames, b.frames);
  compare(compared, a.sensor_model, b.sensor_model);
  return compared.text();
}

FrameSettings of_reference(FrameSettings frames) {
  frames.integration.kernel_length_voxels = 0.0;
  return frames;
}

}  // namespace lapis::mapping
