// lapis_simulator alone in a small flat; participants of lock-step are the test echo, or the test itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "common/mapping/file/map_file.hpp"
#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/services.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/hand_made_participant.hpp"
#include "tests/support/in_run.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using lapis_msgs::msg::Tick;
using ::testing::HasSubstr;

constexpr const char* kSimulator = "lapis_simulator";
constexpr const char* kEcho = "lapis_test_echo";

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

template <class Message>
time::Time stamp_of(const Message& message) {
  return messages::from_message(message.header().stamp());
}

std::map<time::Time, std::vector<std::uint8_t>> images_by_stamp(const std::vector<sensor_msgs::msg::Image>& images) {
  std::map<time::Time, std::vector<std::uint8_t>> out;
  for (const auto& image : images) out[stamp_of(image)] = image.data();
  return out;
}

/// Stamps in order of arrival, without the repetitions that lock-step allows itself.
template <class Message>
std::vector<time::Time> stamps_of(const std::vector<Message>& messages) {
  std::vector<time::Time> out;
  for (const auto& message : messages) {
    const auto stamp = stamp_of(message);
    if (out.empty() || stamp != out.back()) out.push_back(stamp);
  }
  return out;
}

/// Frames 1, 2, 3, ... at 15 Hz.
void expect_every_frame_once(const std::vector<time::Time>& stamps) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    ASSERT_NEAR(stamps[i].seconds(), static_cast<double>(i + 1) / 15.0, 1e-8) << "frame " << i;
  }
}

class SimulatorContract : public ::testing::Test {
 protected:
  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {write_small_scene(folder.path()).string(), "--set",
                                    "simulator.output_dir=" + (folder.path()).string(), "--set",
                                    "simulator.world.light_folder=" + (folder.path() / "light").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::vector<std::string> with_stages(const std::string& stages, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"--set", "lockstep.stages=" + stages};
    all.insert(all.end(), more.begin(), more.end());
    return arguments(all);
  }
  std::string summary() const { return text_of(folder.path() / "simulation.yaml"); }

  TemporaryFolder folder;
};

TEST_F(SimulatorContract, AFrameHasOneStampTrueImagesAndFrameIds) {
  TopicProbe probe;
  const auto& color = probe.collect(topics::kColor);
  const auto& depth = probe.collect(topics::kDepth);
  const auto& labels = probe.collect(topics::kLabels);
  const auto& info = probe.collect(topics::kColorInfo);
  const auto& truth = probe.collect(topics::kGroundTruth);
  const auto& odometry = probe.collect(topics::kWheelOdometry);
  const auto& transforms = probe.collect(topics::kTransforms);
  const auto& mount = probe.collect(topics::kStaticTransforms);
  const auto& names = probe.collect(topics::kLabelInfo);
  ChildProcess simulator(kSimulator, arguments({"--mode", "freerun", "--set", "simulator.wait_for_readers=1", "--set",
                                                "robot.camera.rate_hz=5"}));
  ASSERT_TRUE(probe.wait_until([&] {
    return std::min({color.size(), depth.size(), labels.size(), info.size(), truth.size()}) > 5 &&
           std::min(odometry.size(), transforms.size()) > 20;
  })) << simulator.log();
  // It began when the readers were there: nothing is missing from the first frame on.
  for (std::size_t i = 0; i < 5; ++i) {
    const auto stamp = time::Time{static_cast<std::int64_t>(i + 1) * 200'000'000};
    EXPECT_EQ(stamp_of(color[i]), stamp);
    EXPECT_EQ(stamp_of(depth[i]), stamp);
    EXPECT_EQ(stamp_of(labels[i]), stamp);
    EXPECT_EQ(stamp_of(info[i]), stamp);
    EXPECT_EQ(stamp_of(truth[i]), stamp);
  }
  ASSERT_TRUE(probe.wait_until([&] { return !mount.empty() && !names.empty(); }));
  EXPECT_EQ(names[0].class_map().size(), 10U);
  const auto camera = messages::lens_camera(info[0]);
  ASSERT_TRUE(camera);
  EXPECT_NEAR(camera->pinhole.fx, 320.0, 1e-9);
  EXPECT_NEAR(camera->pinhole.fy, 320.0, 0.01);
  const auto metres = messages::to_depth(depth.back());
  ASSERT_TRUE(metres);
  EXPECT_GT((*metres)(320, 180), 1.0F) << "the start looks at the far wall";
  EXPECT_LT((*metres)(320, 180), 2.5F);
  EXPECT_EQ(color.back().header().frame_id(), "camera_color_optical_frame");
  EXPECT_EQ(truth.back().child_frame_id(), "base_link");
  EXPECT_EQ(odometry.back().header().frame_id(), "odom");
  for (std::size_t i = 0; i < 20; ++i) {  // odom -> base_link is published with each reading
    ASSERT_EQ(transforms[i].transforms().size(), 1U);
    const auto& transform = transforms[i].transforms()[0];
    EXPECT_EQ(transform.header().frame_id(), "odom");
    EXPECT_EQ(transform.child_frame_id(), "base_link");
    const auto reading = std::find_if(odometry.begin(), odometry.end(), [&](const auto& m) {
      return stamp_of(m) == messages::from_message(transform.header().stamp());
    });
    ASSERT_NE(reading, odometry.end());
    const auto T_odom_base = messages::from_message(transform.transform());
    const auto expected = messages::from_message(reading->pose().pose());
    ASSERT_TRUE(T_odom_base && expected);
    EXPECT_TRUE(T_odom_base->isApprox(*expected, 1e-12));
  }
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    EXPECT_EQ((stamp_of(odometry[i]) - stamp_of(odometry[i - 1])).nanoseconds, 20'000'000);
  }
  EXPECT_EQ(simulator.stop(SIGTERM), 0) << simulator.log();
  EXPECT_THAT(summary(), HasSubstr("exit_reason: \"stopped\""));
}

// A command of tick 4 cannot move frame 5, which is being rendered meanwhile. However late it comes, it moves frame 6,
// because it is counted.
TEST_F(SimulatorContract, ACountedCommandActsFromTheNextFrameButOneOnAndTheWatchdogStopsTheRobot) {
  TopicProbe probe;
  HandMadeParticipant slam(probe, "slam");
  auto& command = probe.advertise(topics::kCommand);
  std::map<std::int64_t, double> y;  // true positions by frame
  double speed = 0.0;
  probe.listen<nav_msgs::msg::Odometry>(topics::kGroundTruth, [&](auto& m) {
    y[std::lround(15.0 * stamp_of(m).seconds())] = m.pose().pose().position().y();
    speed = m.twist().twist().linear().x();
  });
  ChildProcess simulator(kSimulator, with_stages("[slam]"));
  const auto step = [&](std::uint64_t tick) {
    ASSERT_TRUE(slam.wait_for_tick(tick)) << simulator.log();
    slam.answer(slam.ticks.back());
  };
  ASSERT_TRUE(probe.wait_until_matched()) << simulator.log();
  for (std::uint64_t tick = 1; tick <= 3; ++tick) step(tick);
  ASSERT_TRUE(slam.wait_for_tick(4));
  slam.publish(slam.answer_to(slam.ticks.back(), command, 1));
  EXPECT_FALSE(probe.wait_until([&] { return slam.ticks.back().tick() > 4; }, Seconds(0.5)));
  geometry_msgs::msg::Twist back;
  back.linear().x(-0.3);  // the wall is in front
  command.publish(back);
  for (std::uint64_t tick = 5; tick <= 30; ++tick) step(tick);
  ASSERT_TRUE(slam.wait_for_tick(31));
  ASSERT_TRUE(probe.wait_until([&] { return y.contains(31); }));
  EXPECT_EQ(y.at(5), y.at(4));
  EXPECT_LT(y.at(6), y.at(5) - 1e-4);
  EXPECT_LT(y.at(9), y.at(4) - 0.03);
  EXPECT_NEAR(speed, 0.0, 1e-3) << "no command for more than half a second";
  EXPECT_GT(y.at(31), 0.2) << "and never in a wall";
}

// Two who command would drive the robot together, and neither where it wants.
TEST_F(SimulatorContract, CommandsOfAStrangerAreRefusedWhileTheRunCommands) {
  std::optional<InRun> run("a");
  TopicProbe probe;
  HandMadeParticipant slam(probe, "slam");
  auto& command = probe.advertise(topics::kCommand);
  const auto& truth = probe.collect(topics::kGroundTruth);
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess simulator(kSimulator, with_stages("[slam]"));
  run.reset();
  TopicProbe stranger("stranger");
  auto& foreign = stranger.advertise(topics::kCommand);
  ASSERT_TRUE(probe.wait_until_matched()) << simulator.log();
  ASSERT_TRUE(stranger.wait_until([&] { return foreign.matched() > 0; })) << simulator.log();
  geometry_msgs::msg::Twist own, strange;
  own.linear().x(-0.05);  // the wall is in front
  strange.angular().z(1.0);
  std::uint64_t tick = 1;
  const auto is_refused = [&] {
    return newest_values(diagnostics, "simulator").contains("refused samples rt/cmd_vel");
  };
  while (tick <= 10 || !is_refused()) {
    ASSERT_TRUE(slam.wait_for_tick(tick)) << simulator.log();
    ASSERT_LT(tick, 300U) << "the stranger is not refused" << simulator.log();
    command.publish(own);
    foreign.publish(strange);  // the last word
    slam.publish(slam.answer_to(slam.ticks.back(), command, tick++));
  }
  EXPECT_TRUE(simulator.wait_for_line("another process publishes this topic", Seconds(2))) << simulator.log();
  ASSERT_FALSE(truth.empty());
  for (const auto& at : truth) EXPECT_NEAR(at.twist().twist().angular().z(), 0.0, 0.01);
  EXPECT_LT(truth.back().twist().twist().linear().x(), -0.01) << "the run's own commands count";
}

/// The run ends with the frame to which the planner says that it has ended, however late its word comes, because it is
/// counted. What an earlier run's planner has said means nothing.
TEST_F(SimulatorContract, EndsWhenThePlannerHasEnded) {
  using namespace lapis_msgs::msg::PlannerStatus_Constants;
  for (const auto& [state, name] :
       {std::pair{STATE_DONE, "DONE"}, {STATE_GAVE_UP, "GAVE_UP"}, {STATE_FAILED, "FAILED"}}) {
    TopicProbe probe;
    HandMadeParticipant planner(probe, "planner");
    auto& status = probe.advertise(topics::kPlannerStatus);
    const auto say = [&](std::uint8_t what, std::uint64_t frame) {
      lapis_msgs::msg::PlannerStatus message;
      message.header().stamp(messages::to_message(time::Time::from_seconds(static_cast<double>(frame) / 15.0)));
      message.state(what);
      message.reason("said in frame " + std::to_string(frame));
      status.publish(message);
    };
    say(STATE_DONE, 3000);
    ChildProcess simulator(kSimulator, with_stages("[planner]", {"--set", "simulator.ends_when_explored=true"}));
    ASSERT_TRUE(planner.wait_for_tick(1)) << simulator.log();
    say(STATE_EXPLORING, 1);
    planner.publish(planner.answer_to(planner.ticks.back(), status, 2));
    ASSERT_TRUE(planner.wait_for_tick(2)) << simulator.log();
    planner.publish(planner.answer_to(planner.ticks.back(), status, 3));
    EXPECT_FALSE(probe.wait_until([&] { return planner.ticks.back().tick() > 2; }, Seconds(0.5)));
    say(state, 2);
    ASSERT_TRUE(planner.wait_for_tick(3)) << simulator.log();
    EXPECT_TRUE(planner.ticks.back().is_final());
    planner.answer(planner.ticks.back());
    EXPECT_EQ(simulator.wait(Seconds(30)), 0) << simulator.log();
    EXPECT_THAT(summary(), HasSubstr("frames: 2\n"));
    EXPECT_THAT(summary(), HasSubstr("exit_reason: \"completed\""));
    EXPECT_THAT(summary(), HasSubstr("planner_state: " + std::string(name) + "\nplanner_reason: \"said in frame 2\""));
  }
}

TEST_F(SimulatorContract, WhoIsDemotedIsNamedAndWithoutAnybodyTheRunFails) {
  const std::string demote = "lockstep.silent_participant=demote";
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ChildProcess simulator(kSimulator, with_stages("[test_echo, nobody]", {"--duration", "1", "--set", demote, "--set",
                                                                         "lockstep.hard_timeout_s=5"}));
  EXPECT_EQ(simulator.wait(Seconds(30)), 0) << simulator.log();
  EXPECT_THAT(summary(), HasSubstr("exit_reason: \"completed\""));
  EXPECT_THAT(summary(), HasSubstr("demoted: {nobody: 0}"));
  ChildProcess alone(kSimulator, with_stages("[nobody]", {"--set", demote, "--set", "lockstep.hard_timeout_s=1"}));
  EXPECT_EQ(alone.wait(Seconds(30)), 1) << alone.log();
  EXPECT_THAT(summary(), HasSubstr("no answer of nobody"));
  EXPECT_THAT(summary(), HasSubstr("no other participant is left"));
}

TEST_F(SimulatorContract, AKilledParticipantEndsTheRunWhichNamesIt) {
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ChildProcess simulator(kSimulator, with_stages("[test_echo]", {"--set", "lockstep.hard_timeout_s=3", "--set",
                                                                 "lockstep.soft_timeout_s=0.5"}));
  ASSERT_TRUE(simulator.wait_for_line("real-time factor")) << simulator.log();
  echo.stop(SIGKILL);
  EXPECT_EQ(simulator.wait(Seconds(15)), 1) << simulator.log();
  EXPECT_THAT(simulator.log(), HasSubstr("no answer of test_echo"));
  EXPECT_THAT(summary(), HasSubstr("no answer of test_echo"));
}

TEST_F(SimulatorContract, ARestartedParticipantMissesNoFrame) {
  TopicProbe probe;
  const auto& truth = probe.collect(topics::kGroundTruth);
  auto echo = std::make_unique<ChildProcess>(kEcho);
  ASSERT_TRUE(wait_until_ready(*echo)) << echo->log();
  ChildProcess simulator(kSimulator, with_stages("[test_echo]", {"--set", "lockstep.silent_participant=wait", "--set",
                                                                 "simulator.max_real_time_factor=1"}));
  ASSERT_TRUE(probe.wait_until([&] { return truth.size() > 5; })) << simulator.log();
  echo->stop(SIGKILL);
  echo = std::make_unique<ChildProcess>(kEcho);
  const auto before = stamps_of(truth).size();
  ASSERT_TRUE(probe.wait_until([&] { return stamps_of(truth).size() > before + 10; }, Seconds(20))) << simulator.log();
  const auto stamps = stamps_of(truth);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    ASSERT_NEAR((stamps[i] - stamps[i - 1]).seconds(), 1.0 / 15.0, 1e-8) << "a frame was skipped or counted twice";
  }
  EXPECT_EQ(simulator.stop(SIGTERM), 0) << simulator.log();
}

TEST_F(SimulatorContract, SlowLateAndWrongAnswersDoNotMoveTheClock) {
  TopicProbe probe;
  HandMadeParticipant slam(probe, "slam");
  const auto& truth = probe.collect(topics::kGroundTruth);
  ChildProcess simulator(kSimulator, with_stages("[slam]", {"--set", "lockstep.soft_timeout_s=0.5"}));
  ASSERT_TRUE(slam.wait_for_tick(1)) << simulator.log();
  Tick wrong = slam.ticks.back();
  wrong.tick(7);
  slam.answer(wrong);
  Tick foreign = slam.ticks.back();
  foreign.run_gid()[0] ^= 0xFF;
  slam.answer(foreign);
  slam.publish(slam.busy_with(slam.ticks.back(), "thinking"));
  // Late: the tick is published again, and the frame with it.
  const auto repetitions = [&] {
    return std::count_if(slam.ticks.begin(), slam.ticks.end(), [](const Tick& tick) { return tick.tick() == 1; });
  };
  ASSERT_TRUE(probe.wait_until([&] { return repetitions() >= 2 && truth.size() >= 2; })) << simulator.log();
  EXPECT_EQ(slam.ticks.back().tick(), 1U);
  EXPECT_EQ(stamps_of(truth).size(), 1U) << "the frame that came again is the same";
  slam.answer(slam.ticks.back());
  slam.answer(slam.ticks.back());  // twice
  ASSERT_TRUE(slam.wait_for_tick(2)) << simulator.log();
  EXPECT_EQ(slam.ticks.back().tick(), 2U);
  slam.answer(slam.ticks.back());
  ASSERT_TRUE(slam.wait_for_tick(3));
  ASSERT_TRUE(probe.wait_until([&] { return stamps_of(truth).size() == 3; }));
  expect_every_frame_once(stamps_of(truth));
}

/// A mapper that the test plays: it says what its map is, and takes part in lock-step.
struct PlayedMapper {
  explicit PlayedMapper(TopicProbe& probe)
      : participant(probe, "semantic_mapper"), map(probe.advertise(topics::kMapDescription)) {}
  void describe_map(double resolution_m) {
    mapping::MapDescription description;
    description.resolution_m = resolution_m;
    description.frames.stride = 3;
    map.publish(messages::to_message(description, {}));
  }

  HandMadeParticipant participant;
  dds::Publisher<lapis_msgs::msg::MapDescription>& map;
};

TEST_F(SimulatorContract, GroundTruthIsBuiltAsTheMapperSaysAndWaitsForThat) {
  TopicProbe probe;
  PlayedMapper mapper(probe);
  ChildProcess simulator(kSimulator, with_stages("[semantic_mapper]"));
  const auto is_waiting = [&] {
    return simulator.log().find("waiting for /semantic_mapper/map_desc") != std::string::npos;
  };
  ASSERT_TRUE(probe.wait_until(is_waiting)) << simulator.log();
  EXPECT_EQ(mapper.participant.ticks.empty() ? 0U : mapper.participant.ticks.back().tick(), 0U);
  mapper.describe_map(0.2);
  for (std::uint64_t tick = 1; tick < 4; ++tick) {
    ASSERT_TRUE(mapper.participant.wait_for_tick(tick)) << simulator.log();
    mapper.participant.answer(mapper.participant.ticks.back());
  }
  ASSERT_TRUE(mapper.participant.wait_for_tick(4)) << simulator.log();
  EXPECT_EQ(simulator.stop(SIGTERM, Seconds(60)), 0) << simulator.log();
  std::string problem;
  const auto ideal = mapping::load_map((folder.path() / "ground_truth/ideal.lapis").string(), problem);
  ASSERT_TRUE(ideal) << problem;
  EXPECT_EQ(ideal->map.resolution_m(), 0.2);
  EXPECT_GT(ideal->map.block_count(), 0U);
  ASSERT_TRUE(ideal->frames);
  EXPECT_EQ(ideal->frames->stride, 3);
  const auto mesh = mapping::load_map((folder.path() / "ground_truth/mesh.lapis").string(), problem);
  ASSERT_TRUE(mesh) << problem;
  EXPECT_EQ(mesh->map.resolution_m(), 0.2);
  EXPECT_FALSE(mesh->frames) << "it is not made of frames";
}

TEST_F(SimulatorContract, AnotherMapThanGroundTruthWasBegunForEndsTheRun) {
  TopicProbe probe;
  PlayedMapper mapper(probe);
  mapper.describe_map(0.25);
  ChildProcess simulator(kSimulator, with_stages("[semantic_mapper]"));
  ASSERT_TRUE(mapper.participant.wait_for_tick(1)) << simulator.log();
  mapper.describe_map(0.1);
  EXPECT_EQ(simulator.wait(Seconds(60)), 1) << simulator.log();
  EXPECT_THAT(simulator.log(), HasSubstr("resolution_m 0.25 and 0.1"));
  EXPECT_THAT(summary(), HasSubstr("resolution_m 0.25 and 0.1"));
}

TEST_F(SimulatorContract, WithoutAMapperNoIdealMapIsMade) {
  ChildProcess simulator(kSimulator, with_stages("[]", {"--duration", "0.5"}));
  EXPECT_EQ(simulator.wait(Seconds(60)), 0) << simulator.log();
  EXPECT_THAT(simulator.log(), HasSubstr("no mapper is there: no ideal.lapis is made"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "ground_truth/mesh.lapis"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "ground_truth/ideal.lapis"));
}

/// The simulator with an echo, and its services.
class SimulatorServices : public SimulatorContract {
 protected:
  void start() {
    ASSERT_TRUE(probe.wait_until([&] {
      return pause.is_ready() && step.is_ready() && run.is_ready() && reset.is_ready() && depth.size() > 3;
    })) << simulator.log();
  }
  std_srvs::srv::Trigger_Response call(dds::ServiceClient<std_srvs::srv::Trigger>& client) {
    const auto number = client.call({});
    std::optional<std_srvs::srv::Trigger_Response> reply;
    EXPECT_TRUE(probe.wait_until([&] { return (reply = client.take_reply(*number)).has_value(); })) << simulator.log();
    return reply.value_or(std_srvs::srv::Trigger_Response());
  }
  /// Stands still, and says at which tick.
  std::uint64_t paused_at() {
    const std::string text = call(pause).message(), begin = "paused at tick ";
    EXPECT_EQ(text.substr(0, begin.size()), begin);
    return text.size() > begin.size() ? std::stoull(text.substr(begin.size())) : 0;
  }
  std::uint64_t last_frame() const {
    return static_cast<std::uint64_t>(std::lround(depth.empty() ? 0.0 : 15.0 * stamp_of(depth.back()).seconds()));
  }
  /// Of a simulator that stands still then.
  bool wait_for_last_frame(std::uint64_t number) {
    return probe.wait_until([&] { return last_frame() == number; });
  }
  /// Of one that runs: several frames may come at once.
  bool wait_until_past(std::uint64_t number) {
    return probe.wait_until([&] { return last_frame() >= number; });
  }

  TopicProbe probe;
  const std::vector<sensor_msgs::msg::Image>& depth = probe.collect(topics::kDepth);
  dds::ServiceClient<std_srvs::srv::Trigger>& pause = probe.client(topics::kPause);
  dds::ServiceClient<std_srvs::srv::Trigger>& step = probe.client(topics::kStep);
  dds::ServiceClient<std_srvs::srv::Trigger>& run = probe.client(topics::kRun);
  dds::ServiceClient<std_srvs::srv::Trigger>& reset = probe.client(topics::kReset);
  ChildProcess echo{kEcho};
  ChildProcess simulator{kSimulator, with_stages("[test_echo]", {"--set", "simulator.max_real_time_factor=1"})};
};

TEST_F(SimulatorServices, PauseStepAndRun) {
  start();
  const std::uint64_t tick = paused_at();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(call(step).success());
  EXPECT_TRUE(wait_for_last_frame(tick + 3)) << simulator.log();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(paused_at(), tick + 3);
  EXPECT_TRUE(call(run).success());
  EXPECT_TRUE(wait_until_past(tick + 10)) << simulator.log();
}

TEST_F(SimulatorServices, AResetBeginsTheSameRunAgain) {
  start();
  ASSERT_TRUE(wait_until_past(25)) << simulator.log();
  const auto first_run = images_by_stamp(depth);
  paused_at();
  EXPECT_TRUE(call(reset).success());
  EXPECT_EQ(paused_at(), 0U) << "still paused";
  call(step);
  ASSERT_TRUE(wait_for_last_frame(1)) << simulator.log();
  const auto second_run = depth.end() - depth.begin() - 1;
  call(run);
  ASSERT_TRUE(wait_until_past(16)) << simulator.log();
  // The same start, seed and (no) commands: the same bytes.
  std::size_t compared = 0;
  for (const auto& [stamp, bytes] : images_by_stamp({depth.begin() + second_run, depth.end()})) {
    const auto known = first_run.find(stamp);
    if (known == first_run.end()) continue;
    EXPECT_EQ(known->second, bytes) << "at " << stamp.seconds() << " s";
    ++compared;
  }
  EXPECT_GT(compared, 5U);
  const std::uint64_t frames = paused_at();
  EXPECT_EQ(simulator.stop(SIGTERM), 0) << simulator.log();
  EXPECT_THAT(summary(), HasSubstr("frames: " + std::to_string(frames) + "\n"));
  const auto value = [this](const std::string& key) {
    return std::stod(summary().substr(summary().find(key) + key.size()));
  };
  EXPECT_GT(value("\nwall_s: "), 0.5) << "15 frames at 15 Hz";
  EXPECT_LT(value("\nreal_time_factor: "), 1.5) << "max_real_time_factor is 1, and the first frame takes no time";
}

TEST_F(SimulatorContract, AResetThatConsumersWouldTakeForDisorderIsRefused) {
  TopicProbe probe;
  HandMadeParticipant slam(probe, "slam");
  auto& reset = probe.client(topics::kReset);
  ChildProcess simulator(kSimulator, with_stages("[slam]"));
  ASSERT_TRUE(slam.wait_for_tick(1)) << simulator.log();
  ASSERT_TRUE(probe.wait_until([&] { return reset.is_ready(); }));
  const auto number = reset.call({});
  std::optional<std_srvs::srv::Trigger_Response> reply;
  ASSERT_TRUE(probe.wait_until([&] { return (reply = reset.take_reply(*number)).has_value(); })) << simulator.log();
  EXPECT_FALSE(reply->success());
  slam.answer(slam.ticks.back());
  EXPECT_TRUE(slam.wait_for_tick(2)) << "the run continues";
}

/// A robot whose watchdog stops it at once, and again after every command, does not get anywhere.
TEST_F(SimulatorContract, ATourThatIsStuckEndsTheRunAndNamesTheWaypoint) {
  ChildProcess simulator(kSimulator,
                         with_stages("[]", {"--tour", "bundled", "--set", "robot.camera.rate_hz=0.1", "--set",
                                            "robot.command_timeout_s=0.05", "--set", "robot.max_speed_m_s=0.01"}));
  EXPECT_EQ(simulator.wait(Seconds(60)), 1) << simulator.log();
  EXPECT_THAT(simulator.log(), HasSubstr("waypoint 1"));
  EXPECT_THAT(summary(), HasSubstr("waypoint 1"));
}

TEST_F(SimulatorContract, GroundTruthThatCannotBeWrittenEndsTheRun) {
  std::ofstream(folder.path() / "ground_truth") << "a file where the folder should be";
  ChildProcess simulator(kSimulator, with_stages("[]"));
  EXPECT_EQ(simulator.wait(Seconds(60)), 1) << simulator.log();
  EXPECT_THAT(simulator.log(), HasSubstr("ground_truth"));
  EXPECT_THAT(summary(), HasSubstr("ground_truth"));
}

TEST_F(SimulatorContract, BadScenesAreNamedBeforeAnythingIsPublished) {
  const auto error_of = [](const std::vector<std::string>& words) {
    ChildProcess simulator(kSimulator, words);
    EXPECT_EQ(simulator.wait(), 2) << simulator.log();
    return simulator.log();
  };
  EXPECT_THAT(error_of({"no_such_scene"}), HasSubstr("scene no_such_scene: no such file"));
  EXPECT_THAT(error_of({}), HasSubstr("no scene given"));
  EXPECT_THAT(error_of(arguments({"--set", "simulator.start=0.05 0.05 0"})), HasSubstr("start"));
  EXPECT_THAT(error_of(arguments({"--set", "simulator.start=here"})), HasSubstr("simulator.start"));
  EXPECT_THAT(error_of(arguments({"--tour", "/no/such/tour.yaml"})), HasSubstr("/no/such/tour.yaml"));
}

TEST_F(SimulatorContract, OneSeedGivesTheSameFilesWithAnyNumberOfThreads) {
  const auto exported = [&](const std::string& name, const std::string& threads, const std::string& seed) {
    const auto out = folder.path() / name;
    ChildProcess simulator(kSimulator, arguments({"--export-tum", out.string(), "--duration", "1", "--seed", seed,
                                                  "--set", "simulator.render_threads=" + threads}));
    EXPECT_EQ(simulator.wait(Seconds(60)), 0) << simulator.log();
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
      if (entry.is_regular_file()) files[std::filesystem::relative(entry.path(), out).string()] = text_of(entry.path());
    }
    return files;
  };
  const auto first = exported("first", "1", "5");
  EXPECT_EQ(first.size(), 15U * 3 + 6 + 8)
      << "rgb, depth and label of 15 frames, lists, poses, camera, classes; ground truth";
  EXPECT_EQ(first, exported("second", "2", "5"));
  EXPECT_NE(first.at("rgb/000001.png"), exported("third", "1", "6").at("rgb/000001.png"));
}

// Nobody to wait for, or a camera that is faster than the machine: a request to stop is still heard.
TEST_F(SimulatorContract, StopsWhenAskedHoweverBusyItIs) {
  for (const auto& options :
       {with_stages("[]"), arguments({"--mode", "freerun", "--set", "robot.camera.rate_hz=120"})}) {
    ChildProcess simulator(kSimulator, options);
    ASSERT_TRUE(simulator.wait_for_line("real-time factor")) << simulator.log();
    EXPECT_EQ(simulator.stop(SIGTERM, Seconds(5)), 0) << simulator.log();
  }
}

/// Processes and participants that start meanwhile use the network, too.
class OnTheSubnet {
 public:
  OnTheSubnet() { setenv(kRange, "SUBNET", 1); }
  ~OnTheSubnet() { setenv(kRange, "LOCALHOST", 1); }
  OnTheSubnet(const OnTheSubnet&) = delete;
  OnTheSubnet& operator=(const OnTheSubnet&) = delete;

 private:
  static constexpr const char* kRange = "ROS_AUTOMATIC_DISCOVERY_RANGE";
};

// The pace of a network is for slow links; 150 frames are ten seconds of the default camera.
TEST_F(SimulatorContract, OnTheSubnetOfOneHostNoFrameIsLeftOut) {
  const OnTheSubnet subnet;
  TopicProbe probe;
  int frames = 0;
  std::set<std::string> reported;
  probe.listen<sensor_msgs::msg::Image>(topics::kColor, [](auto&) {});
  probe.listen<sensor_msgs::msg::Image>(topics::kLabels, [](auto&) {});
  probe.listen<sensor_msgs::msg::Image>(topics::kDepth, [&](auto&) { ++frames; });
  probe.listen<diagnostic_msgs::msg::DiagnosticArray>(topics::kDiagnostics, [&](auto& array) {
    for (const auto& status : array.status()) {
      for (const auto& pair : status.values()) reported.insert(pair.key());
    }
  });
  ChildProcess simulator(kSimulator, arguments({"--mode", "freerun", "--set", "simulator.wait_for_readers=1"}));
  ASSERT_TRUE(probe.wait_until([&] { return frames >= 150; }, Seconds(60))) << simulator.log();
  EXPECT_TRUE(reported.contains("frames")) << simulator.log();
  for (const auto& key : reported) EXPECT_THAT(key, Not(HasSubstr("left out")));
}

TEST_F(SimulatorContract, ToolsWriteWhatTheyName) {
  const auto run = [&](const std::vector<std::string>& options) {
    ChildProcess simulator(kSimulator, arguments(options));
    EXPECT_EQ(simulator.wait(Seconds(60)), 0) << simulator.log();
    return simulator.output();
  };
  const auto exists = [&](const std::string& name) { return std::filesystem::file_size(folder.path() / name) > 0; };
  run({"--snapshot", (folder.path() / "views").string()});
  for (const char* name : {"views/living_1.png", "views/hall_2.png", "views/sheet.png"})
    EXPECT_TRUE(exists(name)) << name;
  run({"--ground-truth", (folder.path() / "truth").string()});
  for (const char* size : {"0.25", "0.10", "0.05"}) {
    for (const char* name : {"mesh.lapis", "with_margin.lapis", "flood.lapis", "classes.json", "rooms.json",
                             "navmap.png", "navmap.yaml"}) {
      EXPECT_TRUE(exists(std::string("truth/") + size + "/" + name)) << size << name;
    }
  }
  EXPECT_THAT(run({"--credits"}), HasSubstr("nothing that others have made"));
  EXPECT_THAT(run({"--help"}), HasSubstr("--validate"));
}

}  // namespace
}  // namespace lapis::test
