#pragma once

#include <map>
#include <optional>
#include <string>

#include "idl/diagnostic_msgs.hpp"
#include "tests/support/synthetic_camera.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {

/// The messages of one camera frame; a test may spoil any of them before they are sent, or leave one out.
struct CameraFrame {
  std::optional<sensor_msgs::msg::Image> color;
  std::optional<sensor_msgs::msg::Image> depth;
  std::optional<sensor_msgs::msg::Image> labels;
  std::optional<sensor_msgs::msg::CameraInfo> info;
};

/// Plays the camera in a test: announces mount and label list, then sends frames of the synthetic camera.
class CameraFeed {
 public:
  static constexpr std::int64_t kPeriod_ns = 33'333'333;

  explicit CameraFeed(TopicProbe& probe, const std::string& frame_prefix = "",
                      const SyntheticCamera& camera = SyntheticCamera());

  /// Frame `index` of the slow motion, with stamp index * period + offset.
  CameraFrame frame(int index) const { return frame(stamp(index), slow_motion(index)); }
  /// What the camera sees from somewhere else, or at another time.
  CameraFrame frame(time::Time stamp, const geometry::Pose& T_box_camera) const;
  void send(const CameraFrame& frame);
  /// True when somebody reads what slam, or the mapper, needs.
  bool is_matched_by_slam() const { return color_.matched() > 0 && depth_.matched() > 0 && color_info_.matched() > 0; }
  bool is_matched_by_mapper() const {
    return labels_.matched() > 0 && depth_.matched() > 0 && color_info_.matched() > 0;
  }
  bool is_matched_by_evaluator() const {
    return labels_.matched() > 0 && depth_.matched() > 0 && depth_info_.matched() > 0;
  }
  static time::Time stamp(int index) { return {1'000'000'000 + index * kPeriod_ns}; }
  const SyntheticCamera& camera() const { return camera_; }

 private:
  SyntheticCamera camera_;
  std::string prefix_;
  dds::Publisher<sensor_msgs::msg::Image>& color_;
  dds::Publisher<sensor_msgs::msg::Image>& depth_;
  dds::Publisher<sensor_msgs::msg::Image>& labels_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& color_info_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& depth_info_;
};

/// What the component says of itself in the newest diagnostics: key -> value.
std::map<std::string, std::string> newest_values(const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics,
                                                 const std::string& component);
/// Sum of the numbers behind all keys that contain `text`.
double sum_of(const std::map<std::string, std::string>& values, const std::string& text);

}  // namespace lapis::test
