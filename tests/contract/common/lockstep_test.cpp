// Lock-step between real processes: the driver runs in the test, echo and follower are the stages of a tick.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "common/topics/camera.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/common/driven.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using State = runtime::LockstepDriver::State;

LockstepConfig config() { return two_stages("abort", 20.0, 5.0); }

class Lockstep : public ::testing::TestWithParam<int> {};

TEST_P(Lockstep, CountedInputsAreWaitedFor) {
  const std::vector<std::string> buffers = {"--set", "dds.socket_buffer_bytes=" + std::to_string(GetParam())};
  ChildProcess echo(kEcho, buffers);
  ChildProcess follower(kFollower, buffers);
  Driven run(config(), GetParam());
  ASSERT_TRUE(run.wait_for(State::kIdle)) << echo.log() << follower.log();
  constexpr std::size_t kTicks = 60;
  for (std::size_t i = 0; i < kTicks; ++i) ASSERT_TRUE(run.step()) << "tick " << i << echo.log() << follower.log();
  expect_complete(run, kTicks);
  EXPECT_EQ(run.republished, 0);
  EXPECT_LT(run.driver().longest_tick_s(), 0.5) << "lost datagrams must be repaired by heartbeats";
}

INSTANTIATE_TEST_SUITE_P(SocketBuffers, Lockstep, ::testing::Values(4 << 20, 212'992));

TEST(LockstepOrder, StagesAreReleasedOneAfterAnotherWithTheCountsOfTheEarlierOnes) {
  TopicProbe observer("observer");
  const auto& ticks = observer.collect(topics::kTick);
  Driven run(config());
  // Only a tick that came proves that the driver's writer knows the observer; nobody has joined, so tick 0 is repeated.
  ASSERT_TRUE(observer.wait_until([&] { return run.wait_for(State::kIdle, Seconds(0.01)) || !ticks.empty(); }));
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  ASSERT_TRUE(run.wait_for(State::kIdle));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(run.step());
  std::map<std::uint64_t, std::uint64_t> echoed;  // odometries counted when the follower was released, by tick
  ASSERT_TRUE(
      observer.wait_until([&] { return !ticks.empty() && ticks.back().tick() == 5 && ticks.back().stage() == 1; }));
  bool is_follower_known = false;  // when tick 1 came, had all been asked to match the follower's reader?
  for (const auto& tick : ticks) {
    if (tick.tick() == 0) {
      const auto& readers = tick.readers();
      const auto of_odometry = [](const auto& reader) { return reader.topic() == "rt/slam/odometry"; };
      is_follower_known = std::count_if(readers.begin(), readers.end(), of_odometry) == 2;  // the test's and its own
      continue;
    }
    EXPECT_TRUE(is_follower_known);
    ASSERT_EQ(tick.due().size(), 1u);
    EXPECT_EQ(tick.due()[0], tick.stage() == 0 ? "test_echo" : "test_follower");
    EXPECT_EQ(messages::from_message(tick.stamp()), Driven::stamp(tick.tick()));
    for (const auto& count : tick.counts()) {
      if (count.topic() == "rt/slam/odometry" && tick.stage() == 1) echoed[tick.tick()] = count.count();
    }
  }
  EXPECT_EQ(echoed, (std::map<std::uint64_t, std::uint64_t>{{1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}}));
}

TEST(LockstepSensors, OneThatIsReadByBestEffortIsNamed) {
  TopicProbe driver("driver");
  auto& tick = driver.advertise(topics::kTick);
  const auto& acks = driver.collect(topics::kAck);
  ChildProcess echo(kEcho, {"--set", "dds.sensor_qos=best_effort"});
  ASSERT_TRUE(driver.wait_until_matched() && driver.wait_until_known_by("test_echo")) << echo.log();
  lapis_msgs::msg::Tick message;
  message.run_gid(tick.gid());
  message.due({"test_echo"});
  tick.publish(message);
  ASSERT_TRUE(driver.wait_until([&] { return !acks.empty(); })) << echo.log();
  EXPECT_EQ(acks.back().status(), lapis_msgs::msg::Ack_Constants::STATUS_BUSY);
  EXPECT_THAT(acks.back().reason(), ::testing::HasSubstr("dds.sensor_qos"));
}

TEST(LockstepEnd, ParticipantWorksFreelyWhenTheDriverLeavesInTheMiddleOfATick) {
  ChildProcess echo(kEcho);
  {
    TopicProbe driver("driver");
    auto& tick = driver.advertise(topics::kTick);
    auto& color = driver.advertise(topics::kColor);
    const auto& acks = driver.collect(topics::kAck);
    ASSERT_TRUE(driver.wait_until_matched() && driver.wait_until_known_by("test_echo")) << echo.log();
    lapis_msgs::msg::Tick message;
    message.run_gid(tick.gid());
    message.due({"test_echo"});
    tick.publish(message);
    ASSERT_TRUE(driver.wait_until([&] { return !acks.empty() && acks.back().status() == 0; }));
    lapis_msgs::msg::TopicCount never;
    never.topic(color.dds_name());
    never.writer_gid(color.gid());
    never.count(5);
    message.tick(1);
    message.counts({never});
    tick.publish(message);
    ASSERT_TRUE(driver.wait_until([&] { return acks.back().tick() == 1; })) << "BUSY is expected";
    EXPECT_EQ(acks.back().status(), lapis_msgs::msg::Ack_Constants::STATUS_BUSY);
  }
  TopicProbe sensor("sensor");
  auto& color = sensor.advertise(topics::kColor);
  const auto& odometry = sensor.collect(topics::kSlamOdometry);
  ASSERT_TRUE(sensor.wait_until_matched() && sensor.wait_until_known_by("test_echo")) << echo.log();
  color.publish({});
  EXPECT_TRUE(sensor.wait_until([&] { return !odometry.empty(); })) << echo.log();
}

TEST(LockstepEnd, AnswerThatWasLostIsGivenAgain) {
  ChildProcess echo(kEcho);
  TopicProbe driver("driver");
  auto& tick = driver.advertise(topics::kTick);
  const auto& acks = driver.collect(topics::kAck);
  ASSERT_TRUE(driver.wait_until_matched() && driver.wait_until_known_by("test_echo")) << echo.log();
  lapis_msgs::msg::Tick message;
  message.run_gid(tick.gid());
  message.due({"test_echo"});
  for (std::size_t i = 1; i <= 3; ++i) {
    tick.publish(message);
    const auto done = [&] {
      return std::count_if(acks.begin(), acks.end(), [](const auto& ack) { return ack.status() == 0; });
    };
    ASSERT_TRUE(driver.wait_until([&] { return static_cast<std::size_t>(done()) >= i; })) << i;
  }
  EXPECT_EQ(acks.back().participant(), "test_echo");
}

}  // namespace
}  // namespace lapis::test
