#pragma once

#include <chrono>
#include <optional>

#include "common/mapping/model/label_list.hpp"
#include "common/messages/camera_frame.hpp"
#include "common/runtime/context.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::runtime {

/// The topics of an RGB-D camera, optionally with labels and ground truth, and the clock of its frames. sensor_replay
/// and simulator both publish with it, so that subscribers cannot distinguish them.
class CameraPublisher {
 public:
  struct Parts {
    bool has_labels = false;
    bool has_ground_truth = false;
  };
  /// @param is_live frames come by the wall clock, whether or not the last one has arrived. So one that a slow network
  /// would carry too late is left out. In lock-step each one is worked on, however late.
  CameraPublisher(Context& context, const Parts& parts, bool is_live);

  const messages::CameraFrameIds& ids() const { return ids_; }
  /// True when the depth images have had `number` readers for half a second, within which the readers' other
  /// subscriptions match. Call it often.
  bool has_readers(std::size_t number);
  /// Publishes the camera mount and the classes, once.
  void publish_latched(const messages::CameraSetUp& cameras, const mapping::LabelList& labels, time::Time stamp);
  /// Publishes the frame, and then its stamp on /clock. Lock-step publishes a frame again when a participant is late.
  /// Images and their infos are all published or all left out, which their writers count.
  void publish(const messages::CameraMessages& messages);

 private:
  using Clock = std::chrono::steady_clock;

  messages::CameraFrameIds ids_;
  dds::Pace& pace_;
  bool is_live_;
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
