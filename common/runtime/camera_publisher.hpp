#pragma once

#include <chrono>
#include <optional>

#include "common/mapping/model/label_list.hpp"
#include "common/messages/camera_frame.hpp"
#include "common/runtime/context.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::runtime {

/// The topics of an RGB-D camera that may know classes and truth, and the clock that goes with its frames: what
/// sensor_replay and simulator publish, so that consumers cannot distinguish them.
class CameraPublisher {
 public:
  struct Parts {
    bool has_labels = false;
    bool has_ground_truth = false;
  };
  CameraPublisher(Context& context, const Parts& parts);

  const messages::CameraFrameIds& ids() const { return ids_; }
  /// True when the depth images have had `number` readers for half a second: their readers of other topics match within
  /// that time. To be asked often.
  bool has_readers(std::size_t number);
  /// Mount and classes, once.
  void publish_latched(const geometry::CameraMount& mount, const mapping::LabelList& labels, time::Time stamp);
  /// The frame, and then its stamp on /clock. Published again by lock-step when a participant was late.
  void publish(const messages::CameraMessages& messages);

 private:
  using Clock = std::chrono::steady_clock;

  messages::CameraFrameIds ids_;
  std::optional<Clock::time_point> matched_since_;
  dds::Publisher<sensor_msgs::msg::Image>& color_;
  dds::Publisher<sensor_msgs::msg::Image>& depth_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& color_info_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& depth_info_;
  dds::Publisher<tf2_msgs::msg::TFMessage>& static_transforms_;
  dds::Publisher<rosgraph_msgs::msg::Clock>& clock_;
  dds::Publisher<sensor_msgs::msg::Image>* labels_ = nullptr;
  dds::Publisher<vision_msgs::msg::LabelInfo>* label_info_ = nullptr;
  dds::Publisher<nav_msgs::msg::Odometry>* ground_truth_ = nullptr;
};

}  // namespace lapis::runtime
