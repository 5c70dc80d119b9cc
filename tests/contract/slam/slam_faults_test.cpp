// lapis_slam alone, with what goes wrong in the world: fault tests F5, F6 and F7 of the project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <random>

#include "common/runtime/status.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "tests/contract/slam/slam_contract.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

class SlamFaults : public SlamContract {
 protected:
  using SlamContract::SlamContract;

  void SetUp() override {
    SlamContract::SetUp();
    for (int i = 0; i < kFirstFrames && !HasFatalFailure(); ++i) {
      ASSERT_TRUE(track(i)) << slam.log();
      ASSERT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    }
  }
  void TearDown() override {
    EXPECT_TRUE(std::all_of(odometry.begin(), odometry.end(), is_finite)) << "a pose is not finite";
    EXPECT_TRUE(slam.is_running()) << slam.log();
  }
  /// Poses come in the order of time, except where a new session begins.
  void expect_poses_in_order() const {
    for (std::size_t i = 1; i < odometry.size(); ++i) EXPECT_LT(stamp_of(odometry[i - 1]), stamp_of(odometry[i])) << i;
  }
  std::size_t tracked_frames() const {
    return static_cast<std::size_t>(
        std::count_if(frames.begin(), frames.end(), [](const auto& f) { return f.state() == kTracking; }));
  }
  /// Sends a frame that must not be tracked, then one that must be.
  void expect_refused(CameraFrame bad, int index, const std::string& reason) {
    SCOPED_TRACE(reason);
    ASSERT_TRUE(answers(bad, index)) << slam.log();
    EXPECT_EQ(frames.back().state(), kLost);
    EXPECT_THAT(frames.back().reason(), HasSubstr(reason));
    EXPECT_TRUE(wait_for_count("frames dropped: " + frames.back().reason(), 1)) << slam.log();
    ASSERT_TRUE(track(index + 1)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(index + 1), slow_motion(0), slow_motion(index + 1));
  }

  static constexpr int kFirstFrames = 5;  // sent by SetUp
};

// F5 ------------------------------------------------------------------------------------------------------------------

TEST_F(SlamFaults, PixelsThatAreNoDepthAreNoMeasurement) {
  using Limits = std::numeric_limits<float>;
  const std::array<float, 8> garbage{Limits::quiet_NaN(),  Limits::infinity(), -Limits::infinity(),    -1.0F, -0.0F,
                                     Limits::denorm_min(), Limits::max(),      Limits::signaling_NaN()};
  for (int i = kFirstFrames; i < kFirstFrames + 8; ++i) {
    auto frame = feed.frame(i);
    frame.depth = feed.camera().depth_metres(CameraFeed::stamp(i), slow_motion(i));
    auto& bytes = frame.depth->data();
    for (std::size_t pixel = 0; pixel < bytes.size() / sizeof(float); pixel += 23)
      std::memcpy(&bytes[pixel * sizeof(float)], &garbage[pixel / 23 % garbage.size()], sizeof(float));
    ASSERT_TRUE(answers(frame, i)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
}

TEST_F(SlamFaults, MessagesThatMakeNoSenseAreRefusedWithTheirReason) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  int index = kFirstFrames;
  const auto refuse = [&](const std::string& reason, const std::function<void(CameraFrame&)>& change) {
    auto frame = feed.frame(index);
    change(frame);
    expect_refused(frame, index, reason);
    index += 2;
  };
  refuse("rows are shorter", [](auto& f) { f.color->step(10); });
  refuse("big-endian", [](auto& f) { f.depth->is_bigendian(1); });
  refuse("depth image is 320x120", [](auto& f) {
    f.depth->height(120);
    f.depth->data().resize(f.depth->data().size() / 2);
  });
  refuse("no valid size", [](auto& f) { f.info->k()[0] = kNan; });
  refuse("no valid size", [](auto& f) { f.info->k()[4] = -200.0; });
  refuse("not finite", [](auto& f) { f.info->d({kNan, 0.0, 0.0, 0.0, 0.0}); });
  refuse("4, 5 or 8 numbers", [](auto& f) { f.info->d({0.1, 0.0}); });
  refuse("distortion model 'ftheta'", [](auto& f) { f.info->distortion_model("ftheta"); });
  refuse("colour encoding 'bayer_rggb8'", [](auto& f) { f.color->encoding("bayer_rggb8"); });
}

TEST_F(SlamFaults, PosesThatAreNoneAreCountedAndNotBelieved) {
  auto& transforms = probe.advertise(topics::kStaticTransforms);
  auto& wheel_odometry = probe.advertise(topics::kWheelOdometry);
  ASSERT_TRUE(probe.wait_until([&] { return transforms.matched() > 0 && wheel_odometry.matched() > 0; }));
  ASSERT_TRUE(probe.wait_until_known_by("slam"));
  tf2_msgs::msg::TFMessage mount = camera_mount();
  mount.transforms()[0].transform().translation().x(std::numeric_limits<double>::quiet_NaN());
  transforms.publish(mount);
  EXPECT_TRUE(wait_for_count("static transforms dropped: pose has numbers that are not finite", 1)) << slam.log();
  mount = camera_mount();
  mount.transforms()[0].transform().rotation().w(3.0);
  transforms.publish(mount);
  EXPECT_TRUE(wait_for_count("static transforms dropped: quaternion is not a unit one", 1)) << slam.log();
  nav_msgs::msg::Odometry reading;
  reading.header().frame_id("odom");
  reading.child_frame_id("base_link");
  for (int i = 0; i < 20; ++i) {
    reading.header().stamp(
        messages::to_message(time::Time{CameraFeed::stamp(kFirstFrames).nanoseconds + i * 1'000'000}));
    reading.pose().pose().position().x(i % 2 == 0 ? std::numeric_limits<double>::infinity() : 0.0);
    wheel_odometry.publish(reading);  // its quaternion is all zero
  }
  EXPECT_TRUE(wait_for_count("odometry dropped: pose has numbers that are not finite", 10)) << slam.log();
  EXPECT_TRUE(wait_for_count("odometry dropped: quaternion is not a unit one", 10)) << slam.log();
  for (int i = kFirstFrames; i < kFirstFrames + 3; ++i) {
    ASSERT_TRUE(track(i)) << slam.log();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
  auto blind = feed.frame(kFirstFrames + 3);
  std::fill(blind.color->data().begin(), blind.color->data().end(), std::uint8_t{0});
  ASSERT_TRUE(answers(blind, kFirstFrames + 3)) << slam.log();
  EXPECT_EQ(frames.back().state(), kLost) << "no odometry was believed, so there is no dead reckoning";
}

// Each name would be a counter of its own.
TEST_F(SlamFaults, InventedFrameNamesCostNoMemory) {
  constexpr int kWarm = 1'000, kNames = 11'000;
  auto& wheel_odometry = probe.advertise(topics::kWheelOdometry);
  ASSERT_TRUE(probe.wait_until([&] { return wheel_odometry.matched() > 0; }));
  ASSERT_TRUE(probe.wait_until_known_by("slam"));
  int sent = 0;
  const auto others = [&] { return count_of(runtime::Status::kOtherCounters); };
  const auto send_until = [&](int names) {  // some are lost, for a reader keeps so many
    return probe.wait_until(
        [&] {
          for (int i = 0; i < 50; ++i) {
            nav_msgs::msg::Odometry reading;
            reading.header().frame_id("invented_" + std::to_string(sent++) + std::string(150, 'x'));
            reading.child_frame_id("base_link");
            wheel_odometry.publish(reading);
          }
          return others() >= names;
        },
        Seconds(60));
  };
  ASSERT_TRUE(send_until(kWarm)) << others() << slam.log();
  const long before_mb = peak_memory_mb(slam.pid());
  ASSERT_TRUE(send_until(kNames)) << others() << slam.log();
  const long grown_mb = peak_memory_mb(slam.pid()) - before_mb;
  std::cout << "figure: " << sent << " names sent; slam grew by " << grown_mb << " MB\n";
  EXPECT_LE(grown_mb, 2);
  EXPECT_LE(newest_values(diagnostics, "slam").size(), 200U);
  ASSERT_TRUE(track(kFirstFrames)) << slam.log();
  expect_pose(CameraFeed::stamp(kFirstFrames), slow_motion(0), slow_motion(kFirstFrames));
}

// F6 ------------------------------------------------------------------------------------------------------------------

// The clock of the camera is set, back and ahead. The topics notice one after the other, in each order. The map goes on
// at the next frame but one.
TEST_F(SlamFaults, ClockThatIsSetKeepsTheMap) {
  enum class First { kColor, kPartners, kNobody };
  const std::int64_t session = frames.back().session();
  std::int64_t step_ns = 0;
  int index = kFirstFrames;
  int steps = 0;
  for (const auto& [more_ns, first] : {std::pair{-5'000'000'000, First::kColor},
                                       {-5'000'000'000, First::kPartners},
                                       {-5'000'000'000, First::kNobody},
                                       {3'600'000'000'000, First::kColor}}) {
    SCOPED_TRACE(steps);
    step_ns += more_ns;
    ++steps;
    const std::size_t before = frames.size();
    const auto stamp = [&](int i) { return time::Time{CameraFeed::stamp(i).nanoseconds + step_ns}; };
    std::array<CameraFrame, 2> now{feed.frame(stamp(index), slow_motion(index)),
                                   feed.frame(stamp(index + 1), slow_motion(index + 1))};
    if (first != First::kNobody) {
      for (CameraFrame& frame : now) {
        CameraFrame ahead;
        if (first == First::kColor) {
          std::swap(ahead.color, frame.color);
        } else {
          std::swap(ahead.depth, frame.depth);
          std::swap(ahead.info, frame.info);
        }
        feed.send(ahead);
      }
    }
    for (const CameraFrame& frame : now) feed.send(frame);
    ASSERT_TRUE(wait_for_answer(stamp(index + 1))) << slam.log();
    for (int i = index + 2; i < index + 5; ++i) {
      feed.send(feed.frame(stamp(i), slow_motion(i)));
      ASSERT_TRUE(wait_for_answer(stamp(i))) << i << slam.log();
    }
    ASSERT_EQ(frames.size(), before + 5);
    for (int i = 0; i < 5; ++i, ++index) {
      const auto& answer = frames[before + static_cast<std::size_t>(i)];
      EXPECT_EQ(stamp_of(answer), stamp(index));
      EXPECT_EQ(answer.state(), kTracking) << i << " " << answer.reason();
      EXPECT_EQ(answer.session(), session) << i;
      expect_pose(stamp(index), slow_motion(0), slow_motion(index));
    }
  }
  EXPECT_EQ(count_of("frames dropped"), 0.0);
  EXPECT_EQ(odometry.size(), frames.size());
  EXPECT_TRUE(wait_for_count("colour: the clock of its source was set", steps)) << slam.log();
  EXPECT_THAT(slam.log(), HasSubstr("the clock of the camera was set by -"));
}

// As when two cameras share a topic for a moment, or a driver stamps a frame before its clock is right.
TEST_F(SlamFaults, FrameWithAWrongStampIsDropped) {
  const std::int64_t session = frames.back().session();
  int index = kFirstFrames;
  for (const std::int64_t wrong_ns : {3'600'000'000'000, -5'000'000'000}) {
    feed.send(feed.frame(time::Time{CameraFeed::stamp(index).nanoseconds + wrong_ns}, slow_motion(index)));
    for (int i = 0; i < 3; ++i, ++index) {
      ASSERT_TRUE(track(index)) << slam.log();
      EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
      EXPECT_EQ(frames.back().session(), session);
      expect_pose(CameraFeed::stamp(index), slow_motion(0), slow_motion(index));
    }
  }
  EXPECT_TRUE(wait_for_count("colour dropped: stamp far from those before and after it", 2)) << slam.log();
  EXPECT_EQ(frames.size(), static_cast<std::size_t>(index));
  expect_poses_in_order();
}

// A source that restarts elsewhere: what it sees is not in the map.
TEST_F(SlamFaults, SourceThatBeginsAnewElsewhereBeginsANewSession) {
  const std::int64_t session = frames.back().session();
  int index = -15'000;  // 500 s before
  ASSERT_TRUE(begin_anew(slam, feed, index, [this](const auto& frame, int i) { return answers(frame, i); }));
  const std::size_t before = frames.size();
  const int first = index;
  for (; index < first + 3; ++index) {
    feed.send(feed.frame(CameraFeed::stamp(index), slow_motion(index + 15'000)));
    ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(index))) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(index), slow_motion(first + 15'000), slow_motion(index + 15'000));
  }
  EXPECT_EQ(frames[before].session(), session + 1);
  EXPECT_EQ(frames[before].keyframe_id(), 0U);
}

// Each message is lost with a probability of 30 %. Who has lost its partners is reported so, the others are tracked.
TEST_F(SlamFaults, ThirtyPercentOfTheMessagesLost) {
  std::mt19937 random(11);
  const auto is_lost = [&random] { return random() % 10 < 3; };
  std::vector<std::pair<int, std::string>> expected;  // answers: number of the frame, reason
  std::size_t without_depth = 0;
  std::size_t without_info = 0;
  constexpr int kEnd = kFirstFrames + 40;
  for (int i = kFirstFrames; i <= kEnd; ++i) {
    const bool is_last = i == kEnd;  // whole, so that nothing waits
    CameraFrame sent = feed.frame(i);
    if (!is_last && is_lost()) sent.color.reset();
    if (!is_last && is_lost()) sent.depth.reset();
    if (!is_last && is_lost()) sent.info.reset();
    feed.send(sent);
    const bool is_whole = sent.color && sent.depth && sent.info;
    if (is_whole) {
      ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(i))) << i << slam.log();
    }
    if (!sent.color) continue;
    expected.emplace_back(i, !sent.depth ? "no depth image" : (!sent.info ? "no camera info" : ""));
    if (!sent.depth) ++without_depth;
    if (sent.depth && !sent.info) ++without_info;
  }
  ASSERT_GT(without_depth, 3U);
  ASSERT_GT(without_info, 3U);
  ASSERT_EQ(frames.size(), kFirstFrames + expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const auto& answer = frames[kFirstFrames + k];
    const auto& [index, reason] = expected[k];
    EXPECT_EQ(stamp_of(answer), CameraFeed::stamp(index));
    EXPECT_EQ(answer.state(), reason.empty() ? kTracking : kLost) << index << " " << answer.reason();
    EXPECT_THAT(answer.reason(), HasSubstr(reason));
    if (reason.empty()) expect_pose(CameraFeed::stamp(index), slow_motion(0), slow_motion(index));
  }
  EXPECT_TRUE(wait_for_count("frames dropped: no depth image", static_cast<double>(without_depth)));
  EXPECT_TRUE(wait_for_count("frames dropped: no camera info", static_cast<double>(without_info)));
  EXPECT_EQ(count_of("frames dropped"), static_cast<double>(without_depth + without_info));
  expect_poses_in_order();
}

// Nobody knows that nothing comes any more: images wait, but not for ever.
TEST_F(SlamFaults, TopicThatFallsSilentIsNamedAndNotWaitedForForEver) {
  int index = kFirstFrames;
  for (const bool is_depth : {true, false}) {
    const std::size_t before = frames.size();
    constexpr int kSilent = 20;
    constexpr int kWaiting = 7;
    for (int i = 0; i < kSilent; ++i, ++index) {
      CameraFrame sent = feed.frame(index);
      if (is_depth) {
        sent.depth.reset();
      } else {
        sent.info.reset();
      }
      feed.send(sent);
      if (i < kWaiting) continue;
      ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(index - kWaiting))) << i << slam.log();
    }
    ASSERT_TRUE(track(index)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(index), slow_motion(0), slow_motion(index));
    ++index;
    ASSERT_EQ(frames.size(), before + kSilent + 1);
    for (int i = 0; i < kSilent; ++i) {
      const auto& answer = frames[before + static_cast<std::size_t>(i)];
      EXPECT_EQ(answer.state(), kLost);
      EXPECT_EQ(answer.reason(), is_depth ? "no depth image for a colour image" : "no camera info for a colour image");
    }
  }
}

// Messages arrive up to half a second late, each on its own, some of them twice.
TEST_F(SlamFaults, HalfASecondOfJitterAndDuplicates) {
  constexpr int kFrames = 40;
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  const auto stamp = [](int i) { return time::Time{2'000'000'000 + i * kPeriod_ns}; };
  std::vector<CameraFrame> sent;
  std::mt19937 random(5);
  std::multimap<std::int64_t, std::function<void()>> arrivals;
  const auto arrive = [&](int i, const std::function<void()>& send) {
    arrivals.emplace(i * kPeriod_ns + static_cast<std::int64_t>(random() % 500'000'000), send);
  };
  sent.reserve(kFrames);
  std::size_t colors = 0;
  for (int i = 0; i < kFrames; ++i) {
    const CameraFrame& frame = sent.emplace_back(feed.frame(stamp(i), slow_motion(kFirstFrames + i)));
    for (int copy = 0; copy < (i % 5 == 0 ? 2 : 1); ++copy) {
      arrive(i, [this, &frame] { feed.send({frame.color, {}, {}, {}}); });
      arrive(i, [this, &frame] { feed.send({{}, frame.depth, {}, {}}); });
      arrive(i, [this, &frame] { feed.send({{}, {}, {}, frame.info}); });
      ++colors;
    }
  }
  for (const auto& [when, send] : arrivals) {
    send();
    probe.wait_until([] { return false; }, Seconds(0.004));
  }
  for (int i = kFrames; i < kFrames + 3; ++i) {  // in order again
    feed.send(feed.frame(stamp(i + 5), slow_motion(kFirstFrames + i)));
    ASSERT_TRUE(wait_for_answer(stamp(i + 5))) << i << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << i << " " << frames.back().reason();
    expect_pose(stamp(i + 5), slow_motion(0), slow_motion(kFirstFrames + i));
  }
  // Every colour image is answered once, or counted with the reason why not; slam's reader keeps five.
  const std::size_t answered = frames.size() - kFirstFrames - 3;
  EXPECT_GT(tracked_frames(), kFirstFrames + 3U) << "some are whole when their turn comes";
  const auto unanswered = [&] {
    return count_of("colour dropped") + count_of("missed samples rt/camera/color/image_raw");
  };
  EXPECT_TRUE(probe.wait_until([&] { return unanswered() >= static_cast<double>(colors - answered); }, Seconds(3)));
  EXPECT_EQ(unanswered(), static_cast<double>(colors - answered)) << slam.log();
  EXPECT_GT(count_of("stamp was there before"), 0.0);
  EXPECT_GT(count_of("older than what was processed"), 0.0);
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_LT(stamp_of(frames[i - 1]), stamp_of(frames[i])) << i;
  for (std::size_t i = kFirstFrames; i + 3 < frames.size(); ++i) {
    if (frames[i].state() != kTracking) continue;
    const auto number = (stamp_of(frames[i]) - stamp(0)).nanoseconds / kPeriod_ns;
    const auto T =
        *messages::from_message(frames[i].keyframe_pose()) * *messages::from_message(frames[i].pose_in_keyframe());
    const auto T_true = T_base_camera() * slow_motion(kFirstFrames + static_cast<double>(number));
    EXPECT_LT((T.translation() - T_true.translation()).norm(), 0.02) << number;
  }
  expect_poses_in_order();
}

// F7 ------------------------------------------------------------------------------------------------------------------

TEST_F(SlamFaults, CoveredCameraIsLostAtOnceAndFindsItsMapAgain) {
  const auto& status = probe.collect(topics::kSlamStatus);
  ASSERT_TRUE(probe.wait_until([&] { return !status.empty(); }));
  int index = kFirstFrames;
  for (const int value : {0, 128, 255}) {  // black, constant, saturated
    SCOPED_TRACE(value);
    ASSERT_NE(odometry_at(CameraFeed::stamp(index - 1)), nullptr);
    const auto poses = odometry.size();
    const auto version = frames.back().graph_version();
    const int view = index;
    constexpr int kCovered = 30;  // one second
    for (int i = 0; i < kCovered; ++i, ++index) {
      auto covered = feed.frame(CameraFeed::stamp(index), slow_motion(view));
      std::fill(covered.color->data().begin(), covered.color->data().end(), static_cast<std::uint8_t>(value));
      if (value == 0) std::fill(covered.depth->data().begin(), covered.depth->data().end(), std::uint8_t{0});
      ASSERT_TRUE(answers(covered, index)) << slam.log();
      EXPECT_EQ(frames.back().state(), kLost) << i;
      EXPECT_NE(frames.back().reason(), "") << i;
      EXPECT_EQ(frames.back().graph_version(), version) << "the map is not touched";
    }
    ASSERT_TRUE(probe.wait_until([&] { return status.back().state() == kLost; })) << slam.log();
    EXPECT_EQ(odometry.size(), poses) << "no pose is made up";
    for (int i = 0; i < 3; ++i, ++index) {
      ASSERT_TRUE(answers(feed.frame(CameraFeed::stamp(index), slow_motion(view + i)), index)) << slam.log();
      EXPECT_EQ(frames.back().state(), kTracking) << i << " " << frames.back().reason();
      EXPECT_EQ(frames.back().session(), frames.front().session());
      expect_pose(CameraFeed::stamp(index), slow_motion(0), slow_motion(view + i));
    }
  }
}

/// A camera without odometry that is carried elsewhere while it is covered.
class CarriedSlam : public SlamFaults {
 protected:
  CarriedSlam() : SlamFaults({"--set", "slam.sub_map.evidence_m=0.5"}) {}

  /// Covers the camera, and shows another view until slam is not lost any more; the index of the next frame.
  int carry(int index) {
    for (const int end = index + 10; index < end; ++index) {
      auto covered = feed.frame(index);
      std::fill(covered.color->data().begin(), covered.color->data().end(), std::uint8_t{0});
      EXPECT_TRUE(answers(covered, index)) << slam.log();
      EXPECT_EQ(frames.back().state(), kLost);
    }
    for (const int last = index + 60; index < last && frames.back().state() == kLost; ++index) {
      EXPECT_TRUE(answers(elsewhere(index), index)) << slam.log();
    }
    return index;
  }
  CameraFrame elsewhere(int index) const {
    const auto turned = geometry::make_pose(
        Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitY())));
    return feed.frame(CameraFeed::stamp(index), slow_motion(index) * turned);
  }
};

// Mapping goes on, and nobody is told a pose that is not known.
TEST_F(CarriedSlam, GoesOnInASubMap) {
  const auto& graphs = probe.collect(topics::kPoseGraph);
  const auto& status = probe.collect(topics::kSlamStatus);
  int index = kFirstFrames;
  for (; index < 90; ++index) ASSERT_TRUE(track(index)) << slam.log();
  ASSERT_NE(odometry_at(CameraFeed::stamp(index - 1)), nullptr);
  const auto poses = odometry.size();
  index = carry(index);
  const auto& begun = frames.back();
  ASSERT_EQ(begun.state(), lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED) << slam.log();
  EXPECT_EQ(begun.source(), lapis_msgs::msg::TrackedFrame_Constants::SOURCE_NONE);
  EXPECT_EQ(begun.session(), frames.front().session());
  EXPECT_TRUE(begun.is_keyframe());
  EXPECT_FALSE(messages::from_message(begun.keyframe_pose()));
  EXPECT_TRUE(messages::from_message(begun.pose_in_keyframe()));
  const auto first_of_it = begun.keyframe_id();
  const auto version = begun.graph_version();
  for (const int end = index + 20; index < end; ++index) ASSERT_TRUE(answers(elsewhere(index), index)) << slam.log();
  ASSERT_TRUE(probe.wait_until([&] { return !graphs.empty() && graphs.back().version() >= version; })) << slam.log();
  for (const auto& node : graphs.back().nodes()) EXPECT_LT(node.id(), first_of_it);
  EXPECT_EQ(status.back().state(), lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED);
  EXPECT_EQ(odometry.size(), poses) << "no pose is made up";
}

// Five frames are no map to which anything could be joined.
TEST_F(CarriedSlam, BeginsAnotherMapWhereTheFirstWasTooSmall) {
  const int index = carry(kFirstFrames);
  EXPECT_EQ(frames.back().state(), kTracking) << slam.log();
  EXPECT_NE(frames.back().session(), frames.front().session());
  EXPECT_THAT(slam.log(), HasSubstr("too few to find its place again: a new map begins"));
  EXPECT_NE(odometry_at(CameraFeed::stamp(index - 1)), nullptr);
}

// 180 degrees per second at 30 Hz, once around. What is published is right; where nothing is known nothing is
// published.
TEST_F(SlamFaults, FastSpinNeverGivesAWrongPose) {
  const auto spin = [](int i) {
    const double angle = 3.14159265358979 * i / 30.0;
    return slow_motion(kFirstFrames) *
           geometry::make_pose(Eigen::Vector3d::Zero(),
                               Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())));
  };
  std::size_t published = 0;
  for (int i = 0; i <= 60; ++i) {
    const int index = kFirstFrames + i;
    ASSERT_TRUE(answers(feed.frame(CameraFeed::stamp(index), spin(i)), index)) << slam.log();
    EXPECT_EQ(frames.back().session(), frames.front().session());
    if (frames.back().state() != kTracking) continue;
    ++published;
    const auto* message = odometry_at(CameraFeed::stamp(index));
    ASSERT_NE(message, nullptr);
    const auto T_true = T_base_camera() * slow_motion(0).inverse() * spin(i) * T_base_camera().inverse();
    const auto error = T_true.inverse() * *messages::from_message(message->pose().pose());
    EXPECT_LT(error.translation().norm(), 0.05) << i;
    EXPECT_LT(geometry::so3_log(error.linear()).norm(), 0.03) << i;
  }
  EXPECT_EQ(odometry.size(), kFirstFrames + published);
  EXPECT_EQ(frames.back().state(), kTracking) << "the first view again: " << frames.back().reason();
}

// The process itself -------------------------------------------------------------------------------------------------

TEST(SlamKilled, StartedAgainItBeginsANewSession) {
  TopicProbe probe;
  CameraFeed feed(probe);
  const auto& frames = probe.collect(topics::kTrackedFrame);
  int index = 0;
  std::int64_t session = -1;
  for (int life = 0; life < 3; ++life) {
    SCOPED_TRACE(life);
    const std::int64_t first_stamp = CameraFeed::stamp(index).nanoseconds;
    ChildProcess slam(kSlam);
    ASSERT_TRUE(wait_until_ready(slam)) << slam.log();
    std::vector<lapis_msgs::msg::TrackedFrame> answers;  // what the life before has said may still come
    const auto has_answered = [&] {
      answers.clear();
      std::copy_if(frames.begin(), frames.end(), std::back_inserter(answers),
                   [&](const auto& frame) { return frame.session() > session; });
      return answers.size() >= 3;
    };
    // Repeated with new stamps: the first ones may be sent before the match.
    ASSERT_TRUE(probe.wait_until([&] {
      feed.send(feed.frame(index++));
      return probe.wait_until(has_answered, Seconds(0.05));
    })) << slam.log();
    for (const auto& answer : answers) {
      EXPECT_EQ(answer.state(), kTracking) << answer.reason();
      EXPECT_EQ(answer.session(), answers.front().session());
    }
    EXPECT_GE(answers.front().session(), first_stamp) << "named by its own first frame";
    session = answers.front().session();
    EXPECT_EQ(slam.stop(SIGKILL), -SIGKILL);
  }
}

}  // namespace
}  // namespace lapis::test
