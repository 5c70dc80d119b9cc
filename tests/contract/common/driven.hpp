#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/time.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {

using runtime::LockstepConfig;
using runtime::LockstepDriver;

inline constexpr const char* kEcho = "lapis_test_echo";
inline constexpr const char* kFollower = "lapis_test_follower";
inline constexpr std::size_t kImageBytes = 921'600;

inline LockstepConfig two_stages(const std::string& policy, double hard_timeout_s, double soft_timeout_s) {
  return {{"test_echo", "test_follower"}, soft_timeout_s, hard_timeout_s, policy};
}

/// The sensor's side of a run.
class Driven {
 public:
  explicit Driven(const LockstepConfig& lockstep, int socket_buffer_bytes = 4 << 20)
      : context_(options(socket_buffer_bytes)), color_(context_.advertise(topics::kColor)) {
    image_.data().resize(kImageBytes);
    context_.subscribe(topics::kSlamOdometry, [this](auto& m) { odometry.push_back(m); });
    context_.subscribe(topics::kTrackedFrame, [this](auto& m) { frames.push_back(m); });
    driver_ = std::make_unique<LockstepDriver>(context_, lockstep, [this] {
      ++republished;
      color_.publish(image_);
    });
  }

  bool wait_until(const std::function<bool()>& condition, Seconds deadline = Seconds(15)) {
    const auto end = std::chrono::steady_clock::now() + deadline;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      context_.executor().spin_once(std::chrono::milliseconds(probe_ == nullptr ? 10 : 2));
      if (probe_ != nullptr) probe_->executor().spin_once(std::chrono::milliseconds(2));
    }
    return true;
  }
  bool wait_for(LockstepDriver::State state, Seconds deadline = Seconds(15)) {
    return wait_until([&] { return driver_->state() == state; }, deadline);
  }
  /// What the next images show.
  void show(const sensor_msgs::msg::Image& image) { image_ = image; }
  /// Publishes the next image and releases its tick.
  void begin() {
    image_.header().stamp(messages::to_message(stamp(++ticks)));
    color_.publish(image_);
    driver_->begin(stamp(ticks), false);
  }
  bool step(Seconds deadline = Seconds(15)) {
    begin();
    return wait_for(LockstepDriver::State::kIdle, deadline);
  }
  void advertise_odometry() { odometry_ = &context_.advertise(topics::kSlamOdometry); }
  void publish_odometry() { odometry_->publish({}); }
  /// While the driver waits, this one receives, too.
  void accompany(TopicProbe& probe) { probe_ = &probe; }
  static time::Time stamp(std::size_t tick) { return {static_cast<std::int64_t>(tick) * 33'333'333}; }
  LockstepDriver& driver() { return *driver_; }

  std::size_t ticks = 0;
  int republished = 0;
  std::vector<nav_msgs::msg::Odometry> odometry;
  std::vector<lapis_msgs::msg::TrackedFrame> frames;

 private:
  static runtime::ContextOptions options(int socket_buffer_bytes) {
    runtime::ContextOptions result{"test_driver", participant_options("test_driver")};
    result.participant.socket_buffer_bytes = socket_buffer_bytes;
    return result;
  }
  runtime::Context context_;
  dds::Publisher<sensor_msgs::msg::Image>& color_;
  dds::Publisher<nav_msgs::msg::Odometry>* odometry_ = nullptr;
  sensor_msgs::msg::Image image_;
  TopicProbe* probe_ = nullptr;
  std::unique_ptr<LockstepDriver> driver_;
};

/// Every tick's stamp once, in order, in both streams, and each frame made when the odometry of its tick was there,
/// but for one tick, whose odometry was published before the follower was born.
inline void expect_complete(const Driven& run, std::size_t ticks, std::size_t tick_before_birth = 0) {
  ASSERT_EQ(run.frames.size(), ticks);
  ASSERT_EQ(run.odometry.size(), ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    EXPECT_EQ(messages::from_message(run.odometry[i].header().stamp()), Driven::stamp(i + 1));
    EXPECT_EQ(messages::from_message(run.frames[i].header().stamp()), Driven::stamp(i + 1));
    EXPECT_EQ(run.frames[i].keyframe_id(), kImageBytes);
    if (i + 1 == tick_before_birth) continue;
    EXPECT_EQ(run.frames[i].reason(), "") << "tick " << i + 1 << " was released before its inputs had come";
  }
}

}  // namespace lapis::test
