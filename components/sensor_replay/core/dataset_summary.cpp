#include "sensor_replay/core/dataset_summary.hpp"

#include <array>
#include <cstdio>
#include <numbers>

namespace lapis::sensor_replay {
namespace {

std::string number(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string line(const std::string& name, const std::string& value) {
  return name + std::string(name.size() < 14 ? 14 - name.size() : 1, ' ') + value + "\n";
}

std::string describe_depth(const TumDataset& dataset) {
  const std::size_t without = dataset.frames_without_depth();
  if (without == 0) return "every frame";
  return std::to_string(dataset.size() - without) + " frames; " + std::to_string(without) + " without";
}

std::string describe_ground_truth(const TumDataset& dataset) {
  if (!dataset.has_ground_truth()) return "none";
  std::size_t frames = 0;
  for (std::size_t i = 0; i < dataset.size(); ++i) frames += dataset.ground_truth(i) ? 1 : 0;
  const auto length = path_length_m(dataset);
  return std::to_string(frames) + " frames" + (length ? ", path " + number(*length, 2) + " m" : "");
}

std::string describe_labels(const TumDataset& dataset) {
  if (!dataset.has_labels()) return "none";
  return std::to_string(dataset.classes().size()) + " classes";
}

std::string describe_pinhole(const geometry::PinholeCamera& camera) {
  return std::to_string(camera.width) + "x" + std::to_string(camera.height) + ", fx " + number(camera.fx, 1) + " fy " +
         number(camera.fy, 1) + " cx " + number(camera.cx, 1) + " cy " + number(camera.cy, 1);
}

std::string describe_camera(const CameraFile& file) {
  return describe_pinhole(file.camera) + ", mounted " + number(file.mount.height_m, 2) + " m high, " +
         number(file.mount.pitch_down_rad * 180.0 / std::numbers::pi, 1) + " deg down";
}

std::string describe_depth_camera(const DepthCameraFile& file) {
  const Eigen::Vector3d& position = file.T_color_depth.translation();
  return describe_pinhole(file.camera.pinhole) + ", " + number(100.0 * position.norm(), 1) + " cm from colour";
}

}  // namespace

std::optional<double> path_length_m(const TumDataset& dataset) {
  std::optional<Eigen::Vector3d> previous;
  std::optional<double> length;
  for (std::size_t i = 0; i < dataset.size(); ++i) {
    const auto T_world_camera = dataset.ground_truth(i);
    if (!T_world_camera) continue;
    const Eigen::Vector3d position = T_world_camera->translation();
    if (previous) length = length.value_or(0.0) + (position - *previous).norm();
    previous = position;
  }
  return length;
}

std::string describe(const TumDataset& dataset) {
  std::string text = line("data set", dataset.folder().string());
  text += line("frames", std::to_string(dataset.size()));
  text += line("duration", number(dataset.duration().seconds(), 3) + " s, from " + time::to_string(dataset.stamp(0)) +
                               ", nominally " + number(dataset.camera().fps, 1) + " Hz");
  text += line("camera", describe_camera(dataset.camera()));
  if (const auto& depth = dataset.camera().depth_camera) text += line("depth camera", describe_depth_camera(*depth));
  text += line("depth", describe_depth(dataset));
  text += line("labels", describe_labels(dataset));
  text += line("ground truth", describe_ground_truth(dataset));
  const auto missing = dataset.missing_images();
  if (!missing.empty()) {
    text += line("missing", std::to_string(missing.size()) + " images, the first is " + missing[0].file.string());
  }
  return text;
}

}  // namespace lapis::sensor_replay
