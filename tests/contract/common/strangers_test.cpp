// What a process does about strangers in its DDS domain: second writers of a stream, other runs, and floods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/in_run.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kProgram = "lapis_test_echo";
constexpr const char* kNode = "test_echo";

template <class Thing, class... Arguments>
std::unique_ptr<Thing> in_run(const char* run, const Arguments&... arguments) {
  const InRun scope(run);
  return std::make_unique<Thing>(arguments...);
}

sensor_msgs::msg::Image image(std::int64_t stamp_ns) {
  sensor_msgs::msg::Image message;
  message.header().stamp(messages::to_message(time::Time{stamp_ns}));
  message.data().resize(10);
  return message;
}

std::map<std::string, std::string> values_of(const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics) {
  std::map<std::string, std::string> values;
  if (diagnostics.empty()) return values;
  for (const auto& pair : diagnostics.back().status().at(0).values()) values[pair.key()] = pair.value();
  return values;
}

/// An echo of run "a", and a listener of the same run. The echo answers images with odometry of the same stamp.
class Strangers : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(*echo)) << echo->log();
    ASSERT_TRUE(listener->wait_until_known_by(kNode));
  }
  dds::Publisher<sensor_msgs::msg::Image>& camera_of(TopicProbe& probe) {
    auto& camera = probe.advertise(topics::kColor);
    EXPECT_TRUE(probe.wait_until([&] { return camera.matched() > 0; }));
    EXPECT_TRUE(probe.wait_until_known_by(kNode));
    return camera;
  }
  /// Publishes images until one is answered. That of a writer that is not matched yet is nobody's.
  bool is_answered(dds::Publisher<sensor_msgs::msg::Image>& camera, Seconds deadline = Seconds(10)) {
    const std::int64_t before = stamp_ns_;  // answers to images of earlier calls may still come
    const auto is_new = [&](const nav_msgs::msg::Odometry& answer) {
      return messages::from_message(answer.header().stamp()).nanoseconds > before;
    };
    return listener->wait_until(
        [&] {
          camera.publish(image(stamp_ns_ += 1'000'000));
          return std::any_of(odometry.begin(), odometry.end(), is_new);
        },
        deadline);
  }
  /// As is_answered(), but waits for the answer to each image, so that none replaces another one.
  bool is_answered_in_turn(dds::Publisher<sensor_msgs::msg::Image>& camera) {
    for (int i = 0; i < 50; ++i) {
      const time::Time stamp{stamp_ns_ += 1'000'000};
      camera.publish(image(stamp.nanoseconds));
      const auto is_answer = [&](const auto& odom) { return messages::from_message(odom.header().stamp()) == stamp; };
      const auto has_come = [&] { return std::any_of(odometry.begin(), odometry.end(), is_answer); };
      if (listener->wait_until(has_come, Seconds(0.2))) return true;
    }
    return false;
  }
  bool wait_for_value(const std::string& key) {
    return listener->wait_until([&] { return values_of(diagnostics).contains(key); }, Seconds(3));
  }

  std::unique_ptr<TopicProbe> listener = in_run<TopicProbe>("a", std::string("listener"));
  const std::vector<nav_msgs::msg::Odometry>& odometry = listener->collect(topics::kSlamOdometry);
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics = listener->collect(topics::kDiagnostics);
  std::unique_ptr<ChildProcess> echo = in_run<ChildProcess>("a", std::string(kProgram));
  std::int64_t stamp_ns_ = 0;
};

constexpr const char* kRefusedImages = "refused samples rt/camera/color/image_raw";

TEST_F(Strangers, SecondCameraIsRefusedAndNamed) {
  auto& camera = camera_of(*listener);
  ASSERT_TRUE(is_answered(camera)) << echo->log();
  TopicProbe stranger("stranger");
  auto& second = camera_of(stranger);
  const std::int64_t far = stamp_ns_ + 3'600'000'000'000;
  ASSERT_TRUE(listener->wait_until([&] {
    second.publish(image(far));
    return values_of(diagnostics).contains(kRefusedImages);
  })) << echo->log();
  EXPECT_TRUE(echo->wait_for_line("another process publishes this topic", Seconds(2))) << echo->log();
  EXPECT_THAT(echo->log(), HasSubstr("a writer without a run"));
  ASSERT_TRUE(is_answered(camera)) << "an image an hour ahead would make its own ones late: " << echo->log();
  for (const auto& message : odometry) EXPECT_LT(messages::from_message(message.header().stamp()).nanoseconds, far);
}

TEST_F(Strangers, CameraWithoutARunIsAcceptedWhereTheRunHasNone) {
  TopicProbe stranger("stranger");
  EXPECT_TRUE(is_answered(camera_of(stranger))) << echo->log();
  EXPECT_FALSE(values_of(diagnostics).contains(kRefusedImages));
}

TEST_F(Strangers, OtherRunIsRefusedAndNamed) {
  const auto other = in_run<TopicProbe>("b", std::string("other"));
  auto& camera = other->advertise(topics::kColor);
  ASSERT_TRUE(echo->wait_for_line("run b is in DDS domain", Seconds(3))) << echo->log();
  ASSERT_TRUE(listener->wait_until([&] {
    camera.publish(image(stamp_ns_ += 1'000'000));
    return values_of(diagnostics).contains(kRefusedImages);
  })) << echo->log();
  EXPECT_EQ(camera.matched(), 0u) << "readers of another run do not count";
  EXPECT_TRUE(odometry.empty());
  EXPECT_EQ(values_of(diagnostics).at("run"), "a");
  EXPECT_TRUE(is_answered(camera_of(*listener))) << echo->log();
}

// The first process was killed: its lease of 3 s has not expired when the second one speaks.
TEST_F(Strangers, SuccessorIsAcceptedAtOnce) {
  const auto first = in_run<TopicProbe>("a", std::string("first"));
  auto& old_camera = camera_of(*first);
  ASSERT_TRUE(is_answered(old_camera)) << echo->log();
  const auto successor = in_run<TopicProbe>("a", std::string("successor"));
  auto& camera = camera_of(*successor);
  ASSERT_TRUE(is_answered(camera)) << echo->log();
  EXPECT_FALSE(is_answered(old_camera, Seconds(1))) << "the old one has lost its place";
  EXPECT_TRUE(is_answered(camera)) << echo->log();
}

// The stranger's images are refused while the run has a camera; that they are not there afterwards is no loss.
TEST_F(Strangers, RefusedImagesAreNotMissed) {
  TopicProbe stranger("stranger");
  auto& strange_camera = camera_of(stranger);
  ASSERT_TRUE(is_answered_in_turn(strange_camera)) << echo->log();
  auto own = in_run<TopicProbe>("a", std::string("own"));
  ASSERT_TRUE(is_answered_in_turn(camera_of(*own))) << echo->log();
  for (int i = 0; i < 3; ++i) strange_camera.publish(image(stamp_ns_ += 1'000'000));
  ASSERT_TRUE(wait_for_value(kRefusedImages)) << echo->log();
  own.reset();
  ASSERT_TRUE(is_answered_in_turn(strange_camera)) << "the run's camera has left: " << echo->log();
  const std::size_t before = diagnostics.size();
  ASSERT_TRUE(listener->wait_until([&] { return diagnostics.size() > before + 1; }));
  EXPECT_FALSE(values_of(diagnostics).contains("missed samples rt/camera/color/image_raw")) << echo->log();
}

TEST_F(Strangers, TicksOfAnotherRunAreRefusedAndNamed) {
  const auto other = in_run<TopicProbe>("b", std::string("other"));
  auto& ticks = other->advertise(topics::kTick);
  ASSERT_TRUE(echo->wait_for_line("run b is in DDS domain", Seconds(3))) << echo->log();
  ASSERT_TRUE(listener->wait_until([&] {
    ticks.publish({});
    return values_of(diagnostics).contains("refused samples rt/sim/tick");
  })) << echo->log();
  EXPECT_TRUE(echo->wait_for_line("rt/sim/tick: ", Seconds(2))) << echo->log();
}

TEST_F(Strangers, CallsOfAnotherRunAreNotServed) {
  const auto other = in_run<TopicProbe>("b", std::string("other"));
  auto& foreign = other->client(topics::kSaveMap);
  ASSERT_TRUE(listener->wait_until([&] {
    foreign.call({});
    return values_of(diagnostics).contains("refused samples rq/semantic_mapper/saveRequest");
  })) << echo->log();
  auto& own = listener->client(topics::kSaveMap);
  ASSERT_TRUE(listener->wait_until([&] { return own.is_ready(); }));
  const auto number = own.call({});
  ASSERT_TRUE(number);
  ASSERT_TRUE(listener->wait_until([&] { return own.take_reply(*number).has_value(); })) << echo->log();
  ASSERT_TRUE(wait_for_value("answers")) << echo->log();
  EXPECT_EQ(values_of(diagnostics).at("answers"), "1");
}

// A flood of requests of which each takes 0.1 s: images are answered all the same.
TEST(Flood, OfRequestsDoesNotStarveAProcess) {
  TopicProbe probe;
  auto& camera = probe.advertise(topics::kColor);
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  auto& client = probe.client(topics::kSaveMap);
  ChildProcess echo(kProgram, {"--set", "test_echo.answer_s=0.1"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until([&] { return camera.matched() > 0 && client.is_ready(); }));
  ASSERT_TRUE(probe.wait_until_known_by(kNode));
  std::int64_t stamp_ns = 0;
  std::uint64_t calls = 0, last = 0;
  const auto flood = [&] {
    for (int i = 0; i < 20; ++i) {
      if (const auto number = client.call({})) last = *number;
      ++calls;
    }
    if (odometry.size() == static_cast<std::size_t>(stamp_ns)) camera.publish(image(++stamp_ns));
    return stamp_ns > 10;  // ten images have been answered
  };
  ASSERT_TRUE(probe.wait_until(flood, Seconds(20))) << odometry.size() << " images answered\n" << echo.log();
  EXPECT_TRUE(probe.wait_until([&] { return client.take_reply(last).has_value(); })) << "the last call has its answer";
  ASSERT_TRUE(probe.wait_until([&] { return values_of(diagnostics).contains("answers"); }));
  EXPECT_LT(std::stoull(values_of(diagnostics).at("answers")), calls / 5) << "calls that wait together are one";
  EXPECT_EQ(echo.stop(SIGTERM), 0) << echo.log();
}

// Each call counts, so that a hundred of them wait: those that come then must not keep the executor busy while the
// service rests.
TEST(Flood, OfDifferentRequestsDoesNotMakeTheExecutorSpin) {
  constexpr int kAnswers = 10;
  constexpr auto kWork = std::chrono::milliseconds(20);
  dds::Participant participant(participant_options("server"));
  int answers = 0;
  dds::ServiceServer<std_srvs::srv::Trigger> server(participant, topics::kStep, [&](const auto&) {
    std::this_thread::sleep_for(kWork);  // work, as that of the echo
    ++answers;
    return std_srvs::srv::Trigger_Response();
  });
  dds::Executor executor;
  executor.add(server);
  TopicProbe probe;
  auto& client = probe.client(topics::kStep);
  ASSERT_TRUE(probe.wait_until([&] { return client.is_ready() && server.matched() > 0; }));
  for (int i = 0; i < 100; ++i) client.call({});
  int turns = 0;
  for (; answers < kAnswers && turns < 10'000; ++turns) {
    client.call({});
    executor.spin_once(std::chrono::seconds(1));
  }
  EXPECT_EQ(answers, kAnswers);
  EXPECT_LE(turns, 20 * kAnswers);
}

}  // namespace
}  // namespace lapis::test
