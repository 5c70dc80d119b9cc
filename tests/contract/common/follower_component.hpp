#pragma once

#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/time/stamp_buffer.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/slam.hpp"

namespace lapis::test {

struct FollowerConfig {};

template <class Field>
void describe(Field& /*field*/, FollowerConfig& /*c*/) {}

/// Second stage of a chain: joins each image with the echo's odometry of the same stamp. In lock-step it says for every
/// image whether the odometry was there, which proves that it had been waited for.
class FollowerComponent {
 public:
  using Config = FollowerConfig;
  static constexpr const char* kName = "test_follower";
  static constexpr const char* kSummary = "Joins images and odometry; for tests.";

  FollowerComponent(const Config& /*config*/, runtime::Context& context)
      : context_(context), frame_(context.advertise(topics::kTrackedFrame)) {
    context.subscribe(topics::kColor, [this](Image& m) {
      const auto stamp = messages::from_message(m.header().stamp());
      images_.push(stamp, std::move(m));
    });
    context.subscribe(topics::kSlamOdometry, [this](Odometry& m) {
      const auto stamp = messages::from_message(m.header().stamp());
      odometry_.push(stamp, std::move(m));
    });
    context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
  }

 private:
  using Image = sensor_msgs::msg::Image;
  using Odometry = nav_msgs::msg::Odometry;

  void work(const runtime::Cycle& cycle) {
    while (!images_.empty()) {
      const time::Time stamp = images_.front().first;
      Odometry* odometry = nullptr;
      const auto match = odometry_.match(stamp, time::Duration{0}, cycle.inputs_complete, odometry);
      if (match == time::Match::kWait) return;
      lapis_msgs::msg::TrackedFrame message;
      message.header().stamp(messages::to_message(stamp));
      message.header().frame_id(context_.frame("camera_color_optical_frame"));
      message.keyframe_id(images_.front().second.data().size());
      message.reason(odometry == nullptr ? "no odometry" : "");
      frame_.publish(message);
      images_.drop_until(stamp);
      odometry_.drop_until(stamp);
    }
  }

  runtime::Context& context_;
  dds::Publisher<lapis_msgs::msg::TrackedFrame>& frame_;
  time::StampBuffer<Image> images_;
  time::StampBuffer<Odometry> odometry_;
};

}  // namespace lapis::test
