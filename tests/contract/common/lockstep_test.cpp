// Lock-step between real processes: the driver runs in the test, echo and follower are the stages of a tick.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>

#include "common/messages/time.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using runtime::LockstepConfig;
using runtime::LockstepDriver;
using ::testing::HasSubstr;
using State = LockstepDriver::State;

constexpr const char* kEcho = "lapis_test_echo";
constexpr const char* kFollower = "lapis_test_follower";
constexpr std::size_t kImageBytes = 921'600;
constexpr double kShortPatience_s = 5.0;  // a hard time-out that loaded machines do not reach while processes join

LockstepConfig config(const std::string& policy = "abort", double hard_timeout_s = 20.0, double soft_timeout_s = 5.0) {
  return {{"test_echo", "test_follower"}, soft_timeout_s, hard_timeout_s, policy};
}

/// The sensor's side of a run.
class Driven {
 public:
  explicit Driven(const LockstepConfig& lockstep, int socket_buffer_bytes = 4 << 20)
      : context_(options(socket_buffer_bytes)), color_(context_.advertise(topics::kColor)) {
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
      context_.executor().spin_once(std::chrono::milliseconds(10));
    }
    return true;
  }
  bool wait_for(State state, Seconds deadline = Seconds(15)) {
    return wait_until([&] { return driver_->state() == state; }, deadline);
  }
  /// Publishes the next image and releases its tick.
  void begin() {
    image_.header().stamp(messages::to_message(stamp(++ticks)));
    image_.data().resize(kImageBytes);
    color_.publish(image_);
    driver_->begin(stamp(ticks), false);
  }
  bool step(Seconds deadline = Seconds(15)) {
    begin();
    return wait_for(State::kIdle, deadline);
  }
  void advertise_odometry() { odometry_ = &context_.advertise(topics::kSlamOdometry); }
  void publish_odometry() { odometry_->publish({}); }
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
  std::unique_ptr<LockstepDriver> driver_;
};

/// One frame per tick, in order, each made when image and odometry of its tick were there.
void expect_complete(Driven& run, std::size_t ticks) {
  ASSERT_TRUE(run.wait_until([&] { return run.frames.size() >= ticks && run.odometry.size() >= ticks; }))
      << run.frames.size() << " frames and " << run.odometry.size() << " odometries of " << ticks << " ticks";
  EXPECT_EQ(run.frames.size(), ticks);
  EXPECT_EQ(run.odometry.size(), ticks);
  for (std::size_t i = 0; i < std::min(ticks, run.frames.size()); ++i) {
    EXPECT_EQ(messages::from_message(run.frames[i].header().stamp()), Driven::stamp(i + 1));
    EXPECT_EQ(run.frames[i].reason(), "") << "tick " << i + 1 << " was released before its inputs had come";
    EXPECT_EQ(run.frames[i].keyframe_id(), kImageBytes);
  }
}

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

TEST(LockstepSilence, FrameAndTickAreRepeatedAndReceiversDropWhatTheyHad) {
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  Driven run(config("abort", 20.0, 0.3));
  ASSERT_TRUE(run.wait_for(State::kIdle));
  ASSERT_TRUE(run.step());
  follower.signal(SIGSTOP);
  run.begin();
  EXPECT_TRUE(run.wait_until([&] { return run.republished >= 2; }));
  EXPECT_EQ(run.driver().state(), State::kWaiting);
  follower.signal(SIGCONT);
  ASSERT_TRUE(run.wait_for(State::kIdle)) << follower.log();
  ASSERT_TRUE(run.step());
  expect_complete(run, 3);
}

TEST(LockstepSilence, AbortNamesTheSilentOne) {
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  ASSERT_TRUE(wait_until_ready(echo) && wait_until_ready(follower)) << echo.log() << follower.log();
  Driven run(config("abort", kShortPatience_s, 0.5));
  ASSERT_TRUE(run.wait_for(State::kIdle));
  ASSERT_TRUE(run.step());
  follower.stop(SIGKILL);
  run.begin();
  ASSERT_TRUE(run.wait_for(State::kFailed));
  EXPECT_THAT(run.driver().failure(), HasSubstr("no answer of test_follower to tick 2"));
  EXPECT_THAT(run.driver().failure(), Not(HasSubstr("test_echo")));
}

TEST(LockstepSilence, AbortNamesTheOneThatNeverCame) {
  ChildProcess echo(kEcho);
  Driven run(config("abort", 2.0));
  ASSERT_TRUE(run.wait_for(State::kFailed));
  EXPECT_THAT(run.driver().failure(), HasSubstr("test_follower"));
  EXPECT_THAT(run.driver().failure(), HasSubstr("lockstep.stages"));
}

TEST(LockstepSilence, DemoteGoesOnWithout) {
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  ASSERT_TRUE(wait_until_ready(echo) && wait_until_ready(follower)) << echo.log() << follower.log();
  Driven run(config("demote", kShortPatience_s, 0.5));
  ASSERT_TRUE(run.wait_for(State::kIdle));
  ASSERT_TRUE(run.step());
  follower.stop(SIGKILL);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(run.step()) << i;
  ASSERT_TRUE(run.wait_until([&] { return run.odometry.size() == 4; }));
  EXPECT_EQ(run.frames.size(), 1u);
}

// Policy wait with the default time-outs: the restarted process must work again within 3 s of its ready line.
void expect_restart(const std::string& killed) {
  SCOPED_TRACE(killed);
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  Driven run(config("wait", 30.0, 5.0));
  ASSERT_TRUE(run.wait_for(State::kIdle));
  ASSERT_TRUE(run.step());
  (killed == kEcho ? echo : follower).stop(SIGKILL);
  run.begin();
  ChildProcess again(killed);
  ASSERT_TRUE(wait_until_ready(again)) << again.log();
  ASSERT_TRUE(run.wait_for(State::kIdle, Seconds(3))) << again.log();
  const auto odometries = run.odometry.size();
  const auto frames = run.frames.size();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(run.step()) << i << again.log();
  ASSERT_TRUE(run.wait_until([&] { return run.odometry.size() >= odometries + 5 && run.frames.size() >= frames + 5; }));
  EXPECT_EQ(run.frames.back().reason(), "") << "the streams are joined again";
  EXPECT_EQ(messages::from_message(run.frames.back().header().stamp()), Driven::stamp(7));
}

TEST(LockstepRestart, FirstStage) { expect_restart(kEcho); }
TEST(LockstepRestart, LastStage) { expect_restart(kFollower); }

// Each new one is told of the endpoints of the other's former life until that has dropped out of discovery.
TEST(LockstepRestart, BothAtOnce) {
  auto echo = std::make_unique<ChildProcess>(kEcho);
  auto follower = std::make_unique<ChildProcess>(kFollower);
  Driven run(config("wait", 30.0, 5.0));
  ASSERT_TRUE(run.wait_for(State::kIdle));
  ASSERT_TRUE(run.step());
  echo->stop(SIGKILL);
  follower->stop(SIGKILL);
  run.begin();
  echo = std::make_unique<ChildProcess>(kEcho);
  follower = std::make_unique<ChildProcess>(kFollower);
  ASSERT_TRUE(run.wait_for(State::kIdle, Seconds(12))) << echo->log() << follower->log();
  const auto frames = run.frames.size();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(run.step()) << i;
  ASSERT_TRUE(run.wait_until([&] { return run.frames.size() >= frames + 3; }));
  EXPECT_EQ(run.frames.back().reason(), "");
}

TEST(LockstepRestart, NewDriverFindsOldParticipants) {
  ChildProcess echo(kEcho);
  ChildProcess follower(kFollower);
  for (int life = 0; life < 2; ++life) {
    Driven run(config());
    ASSERT_TRUE(run.wait_for(State::kIdle)) << echo.log() << follower.log();
    run.ticks = static_cast<std::size_t>(life) * 100;  // stamps go on
    const auto before = run.frames.size();
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(run.step()) << life << echo.log() << follower.log();
    ASSERT_TRUE(run.wait_until([&] { return run.frames.size() >= before + 3; }));
  }
}

// The echo's odometries of the earlier run are counted in tick 0, and will never reach the new follower.
TEST(LockstepRestart, NewDriverAndNewFollowerDoNotWaitForTheEarlierRun) {
  ChildProcess echo(kEcho);
  for (int life = 0; life < 2; ++life) {
    ChildProcess follower(kFollower);
    Driven run(config());
    ASSERT_TRUE(run.wait_for(State::kIdle)) << life << echo.log() << follower.log();
    run.ticks = static_cast<std::size_t>(life) * 100;  // stamps go on
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(run.step()) << life << echo.log() << follower.log();
    ASSERT_TRUE(run.wait_until([&] { return run.frames.size() >= 3; }));
    EXPECT_EQ(run.frames.back().reason(), "");
  }
}

TEST(LockstepRestart, ATopicThatStaysSilentIsNotWaitedFor) {
  LockstepConfig lockstep = config("wait", 30.0, 5.0);
  lockstep.stages = {"test_follower"};
  auto follower = std::make_unique<ChildProcess>(kFollower);
  Driven run(lockstep);
  run.advertise_odometry();
  ASSERT_TRUE(run.wait_for(State::kIdle));
  run.publish_odometry();  // once, and never again
  ASSERT_TRUE(run.step());
  follower->stop(SIGKILL);
  run.begin();
  follower = std::make_unique<ChildProcess>(kFollower);
  ASSERT_TRUE(run.wait_for(State::kIdle)) << follower->log();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(run.step()) << i << follower->log();
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
