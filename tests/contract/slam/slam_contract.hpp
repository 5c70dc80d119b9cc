#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"

namespace lapis::test {

inline constexpr const char* kSlam = "lapis_slam";
inline constexpr auto kTracking = lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING;
inline constexpr auto kDeadReckoning = lapis_msgs::msg::TrackedFrame_Constants::STATE_DEAD_RECKONING;
inline constexpr auto kLost = lapis_msgs::msg::TrackedFrame_Constants::STATE_LOST;

template <class Message>
time::Time stamp_of(const Message& message) {
  return messages::from_message(message.header().stamp());
}

inline bool is_finite(const nav_msgs::msg::Odometry& message) {
  const auto& covariance = message.pose().covariance();
  const auto& twist = message.twist().twist();
  return messages::from_message(message.pose().pose()).value.has_value() &&
         std::all_of(covariance.begin(), covariance.end(), [](double v) { return std::isfinite(v); }) &&
         std::isfinite(twist.linear().x()) && std::isfinite(twist.linear().y()) && std::isfinite(twist.linear().z()) &&
         std::isfinite(twist.angular().x()) && std::isfinite(twist.angular().y()) && std::isfinite(twist.angular().z());
}

/// Sends frames in which nothing can be seen, from `index` on, whose stamps are far from those before, until slam
/// begins a new map; `index` is then that of the next frame. `answers` sends a frame and waits for its answer.
template <class Answers>
bool begin_anew(const ChildProcess& slam, CameraFeed& feed, int& index, const Answers& answers) {
  const auto blind = [&feed](int i) {
    CameraFrame frame = feed.frame(i);
    std::fill(frame.color->data().begin(), frame.color->data().end(), std::uint8_t{0});
    return frame;
  };
  feed.send(blind(index++));  // is kept until the next one has come
  for (const int last = index + 30; slam.log().find("a new map begins") == std::string::npos; ++index) {
    if (index == last || !answers(blind(index), index)) return false;
  }
  return true;
}

/// slam, a camera and somebody who listens.
class SlamContract : public ::testing::Test {
 protected:
  explicit SlamContract(const std::vector<std::string>& arguments = {},
                        const SyntheticCamera& camera = SyntheticCamera())
      : feed(probe, "", camera), slam(kSlam, arguments) {}

  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(slam)) << slam.log();
    ASSERT_TRUE(probe.wait_until([&] { return is_matched(); })) << slam.log();
    ASSERT_TRUE(probe.wait_until_known_by("slam")) << slam.log();
  }
  virtual bool is_matched() const { return feed.is_matched_by_slam(); }

  /// Sends a frame and waits for its answer on /slam/frame.
  bool track(int index) { return answers(feed.frame(index), index); }
  bool answers(const CameraFrame& frame, int index) {
    feed.send(frame);
    return wait_for_answer(CameraFeed::stamp(index));
  }
  bool wait_for_answer(time::Time stamp) {
    return probe.wait_until([&] { return !frames.empty() && stamp_of(frames.back()) == stamp; });
  }
  /// Waits until the sum of the diagnostics counters that contain `text` is at least `number`.
  bool wait_for_count(const std::string& text, double number) {
    return probe.wait_until([&] { return count_of(text) >= number; }, Seconds(5));
  }
  double count_of(const std::string& text) const { return sum_of(newest_values(diagnostics, "slam"), text); }

  /// Waits for the pose of the frame with this stamp; null when none comes.
  const nav_msgs::msg::Odometry* odometry_at(time::Time stamp) {
    auto at = odometry.rend();
    probe.wait_until(
        [&] {
          at = std::find_if(odometry.rbegin(), odometry.rend(), [&](const auto& m) { return stamp_of(m) == stamp; });
          return at != odometry.rend();
        },
        Seconds(2));
    return at == odometry.rend() ? nullptr : &*at;
  }
  /// Compares the pose published for `stamp` with where the camera is, when it was at `T_box_first` in a map's first
  /// frame.
  void expect_pose(time::Time stamp, const geometry::Pose& T_box_first, const geometry::Pose& T_box_camera) {
    const auto* message = odometry_at(stamp);
    ASSERT_NE(message, nullptr) << "no pose for " << time::to_string(stamp) << slam.log();
    ASSERT_TRUE(is_finite(*message));
    const auto T_expected = T_base_camera() * T_box_first.inverse() * T_box_camera * T_base_camera().inverse();
    const auto error = T_expected.inverse() * *messages::from_message(message->pose().pose());
    EXPECT_LT(error.translation().norm(), 0.02) << time::to_string(stamp);
    EXPECT_LT(geometry::so3_log(error.linear()).norm(), 0.01) << time::to_string(stamp);
  }

  TopicProbe probe;
  CameraFeed feed;
  const std::vector<lapis_msgs::msg::TrackedFrame>& frames = probe.collect(topics::kTrackedFrame);
  const std::vector<nav_msgs::msg::Odometry>& odometry = probe.collect(topics::kSlamOdometry);
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess slam;
};

}  // namespace lapis::test
