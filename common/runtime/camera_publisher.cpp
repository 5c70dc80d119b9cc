#include "common/runtime/camera_publisher.hpp"

#include "common/messages/labels.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::runtime {

namespace {

constexpr std::chrono::milliseconds kSettling(500);

}  // namespace

CameraPublisher::CameraPublisher(Context& context, const Parts& parts, bool is_live)
    : ids_{context.frame("base_link"), context.frame("camera_link"), context.frame("camera_color_optical_frame"),
           context.frame("camera_depth_optical_frame"), "world"},
      pace_(context.participant().pace()), is_live_(is_live), color_(context.advertise(topics::kColor)),
      depth_(context.advertise(topics::kDepth)), color_info_(context.advertise(topics::kColorInfo)),
      depth_info_(context.advertise(topics::kDepthInfo)),
      static_transforms_(context.advertise(topics::kStaticTransforms)), clock_(context.advertise(topics::kClock)) {
  if (parts.has_labels) {
    labels_ = &context.advertise(topics::kLabels);
    label_info_ = &context.advertise(topics::kLabelInfo);
  }
  if (parts.has_ground_truth) ground_truth_ = &context.advertise(topics::kGroundTruth);
}

bool CameraPublisher::has_readers(std::size_t number) {
  if (number == 0) return true;
  if (depth_.matched() < number) {
    matched_since_.reset();
    return false;
  }
  if (!matched_since_) matched_since_ = Clock::now();
  return Clock::now() - *matched_since_ >= kSettling;
}

void CameraPublisher::publish_latched(const messages::CameraSetUp& cameras, const mapping::LabelList& labels,
                                      time::Time stamp) {
  static_transforms_.publish(messages::to_static_transforms(cameras, ids_, stamp));
  if (label_info_ != nullptr) label_info_->publish(messages::to_message(labels, stamp, ids_.optical));
}

void CameraPublisher::publish(const messages::CameraMessages& messages) {
  if (messages.ground_truth && ground_truth_ != nullptr) ground_truth_->publish(*messages.ground_truth);
  const bool is_late = is_live_ && !pace_.has_room(dds::Pace::Clock::now());
  const auto send = [is_late](auto& publisher, const auto& message) {
    if (is_late) return publisher.leave_out();
    publisher.publish(message);
  };
  send(color_info_, messages.color_info);
  send(depth_info_, messages.depth_info);
  send(color_, messages.color);
  if (messages.depth) send(depth_, *messages.depth);
  if (messages.labels && labels_ != nullptr) send(*labels_, *messages.labels);
  rosgraph_msgs::msg::Clock now;
  now.clock(messages.color.header().stamp());
  clock_.publish(now);
}

}  // namespace lapis::runtime
