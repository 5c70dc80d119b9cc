// lapis_controller alone: it drives, it stops when it knows too little, and nothing makes it say what is not a number.
#include "tests/contract/controller/controller_contract.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <iostream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace lapis::test {
namespace {

using ::testing::HasSubstr;
namespace Constants = lapis_msgs::msg::ControllerStatus_Constants;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod_s = 1.0 / kRate_hz;
constexpr double kStopWithin_s = 0.3;  // of the last message of whatever is missing

TEST_F(LockstepController, EachTickHasOneCommandWhichIsZeroWithoutAPath) {
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(tick()) << controller.log();
    EXPECT_TRUE(is_zero(commands.back()));
  }
  EXPECT_EQ(statuses.back().state(), Constants::STATE_IDLE);
  EXPECT_EQ(statuses.back().reason(), "no path yet");
}

TEST_F(LockstepController, FollowsThePathToItsEnd) {
  world.send_path({{0, 0}, {1, 0}, {2, 1}});
  bool had_local_path = false;
  for (int i = 0;
       i < 12 * kRate_hz && !(statuses.size() > 1 && statuses.back().reason() == "the path's end is reached"); ++i) {
    ASSERT_TRUE(tick()) << controller.log();
    had_local_path |= local_path.poses().size() > 5 && local_path.header().frame_id() == "map";
  }
  EXPECT_EQ(statuses.back().reason(), "the path's end is reached");
  EXPECT_LT((world.position - Eigen::Vector2d(2, 1)).norm(), 0.2);
  EXPECT_LT(std::abs(world.yaw_rad), 0.2) << "the last pose's heading";
  EXPECT_TRUE(had_local_path);
}

TEST_F(LockstepController, TurnsOnTheSpotWithoutAPoseAndAMap) {
  world.yaw_rad = 0.7;
  world.send_turn({2.0, 4.0, 6.0});
  const Speaking without{.pose = false, .map = false};
  ASSERT_LE(ticks_until(false, 1.0, without), 0.2);
  EXPECT_EQ(statuses.back().state(), Constants::STATE_FOLLOWING);
  EXPECT_EQ(statuses.back().reason(), "turns on the spot");
  EXPECT_NEAR(ticks_until(true, 30.0, without), 6.0 / 0.3, 0.5) << "slowly";
  EXPECT_EQ(statuses.back().reason(), "the turn is done");
  EXPECT_EQ(statuses.back().state(), Constants::STATE_IDLE);
  EXPECT_NEAR(world.yaw_rad, 6.7, 0.1);
  EXPECT_EQ(world.position, Eigen::Vector2d(0.0, 0.0));
}

TEST_F(LockstepController, APathInBaseLinkThatLeadsAwayIsRefused) {
  get_going();
  world.send_turn({1.0});
  ASSERT_TRUE(tick());
  EXPECT_EQ(commands.back().linear().x(), 0.0);
  EXPECT_EQ(statuses.back().reason(), "turns on the spot");
  nav_msgs::msg::Path away;
  away.header(messages::header(world.stamp, "base_link"));
  away.poses().resize(1);
  away.poses()[0].pose().position().x(1.0);
  away.poses()[0].pose().orientation().w(1.0);
  world.path.publish(away);
  ASSERT_TRUE(tick());
  EXPECT_TRUE(is_zero(commands.back()));
  EXPECT_EQ(statuses.back().reason(), "path refused: in base_link it may only turn on the spot");
  world.send_turn({1.0}, "odom");
  ASSERT_TRUE(tick());
  EXPECT_TRUE(is_zero(commands.back()));
  EXPECT_EQ(statuses.back().reason(), "path refused: its frame is neither map nor base_link");
}

/// Of a robot that measures no motion.
class ControllerWithOdometry : public LockstepController {
 protected:
  ControllerWithOdometry() : LockstepController({"--set", "controller.publish_odometry=true"}) {}
};

TEST_F(ControllerWithOdometry, PublishesAFrameAheadWhereItsCommandsLead) {
  get_going();
  world.send_path({});
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << controller.log();
  const auto is_newest = [&](const std_msgs::msg::Header& header) {
    return std::abs((messages::from_message(header.stamp()) - world.stamp).seconds() - kPeriod_s) < 1e-6;
  };
  ASSERT_TRUE(wait_until([&] { return !readings.empty() && is_newest(readings.back().header()); }));
  EXPECT_EQ(readings.size(), 40U - 5U) << "silent for 0.3 s, so that slam begins a new track after a restart";
  const auto& last = readings.back();
  EXPECT_EQ(last.header().frame_id(), "odom");
  EXPECT_EQ(last.child_frame_id(), "base_link");
  // The robot of the test does at once what it is told; drives brake no harder than robot.max_acceleration_m_s2.
  const double last_m_s = commands[commands.size() - 21].linear().x(), braking_m = last_m_s * last_m_s / (2.0 * 1.5);
  EXPECT_GT(last_m_s, 0.4);
  EXPECT_GT(last.pose().pose().position().x(), world.position.x() - 1e-6);
  EXPECT_LT(last.pose().pose().position().x(), world.position.x() + braking_m);
  EXPECT_NEAR(last.twist().twist().linear().x(), 0.0, 1e-2);
  ASSERT_TRUE(wait_until([&] {
    return !transforms.transforms().empty() && transforms.transforms()[0].header().stamp() == last.header().stamp();
  }));
  EXPECT_EQ(transforms.transforms()[0].transform().translation().x(), last.pose().pose().position().x());
}

// F16 and F2: within 300 ms of the last message ---------------------------------------------------------------------

TEST_F(LockstepController, StandsStillWithoutAPose) {
  get_going();
  EXPECT_LE(ticks_until(true, 2.0, {.pose = false}), kStopWithin_s);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(tick({.pose = false}));
    EXPECT_TRUE(is_zero(commands.back()));
  }
  EXPECT_EQ(statuses.back().state(), Constants::STATE_STOPPED);
  EXPECT_THAT(statuses.back().reason(), HasSubstr("no pose for more than"));
  EXPECT_LE(ticks_until(false, 1.0), 0.5) << "and continues with one";
}

TEST_F(LockstepController, StandsStillWithoutDepthImages) {
  get_going();
  EXPECT_LE(ticks_until(true, 2.0, {.camera = false}), kStopWithin_s);
}

TEST_F(LockstepController, StandsStillWithoutAMap) {
  get_going();
  EXPECT_LE(ticks_until(true, 2.0, {.map = false}), kStopWithin_s);
  EXPECT_THAT(statuses.back().reason(), HasSubstr("no map for more than 0.22 s"));
  EXPECT_LE(ticks_until(false, 1.0), 0.5) << "and continues with one";
}

TEST_F(LockstepController, StandsStillWithAMapThatComesButIsOld) {
  get_going();
  const auto old = world.stamp;
  world.spoil_map = [&](auto& m) { m.header().stamp(messages::to_message(old)); };
  EXPECT_LE(ticks_until(true, 2.0), kStopWithin_s);
  EXPECT_THAT(statuses.back().reason(), HasSubstr("no map for more than"));
}

TEST_F(LockstepController, StandsStillWithoutAPlanner) {
  get_going();
  EXPECT_LE(ticks_until(true, 2.0, {.planner = false}), kStopWithin_s);
  EXPECT_THAT(statuses.back().reason(), HasSubstr("no sign of life of the planner"));
  EXPECT_LE(ticks_until(false, 1.0), 0.5) << "and continues with one";
}

TEST_F(LockstepController, MissingTwoMessagesInARowIsNoReasonToStop) {
  get_going();
  for (int i = 0; i < 30; ++i) {
    const bool speaks = i % 3 == 0;
    ASSERT_TRUE(tick({.pose = speaks, .map = speaks, .planner = speaks}));
    EXPECT_FALSE(is_zero(commands.back())) << statuses.back().reason();
  }
}

TEST_F(LockstepController, EmptyPathStopsWithTheNextTick) {
  get_going();
  world.send_path({});
  ASSERT_TRUE(tick());
  EXPECT_TRUE(is_zero(commands.back()));
  EXPECT_EQ(statuses.back().reason(), "the planner's path is empty");
}

TEST_F(LockstepController, ObstaclePutOnThePathIsAvoidedOrStoppedFor) {
  get_going();
  const double x = world.position.x() + kRadius_m + 0.6;
  world.boxes.push_back({{x, -0.4, 0}, {x + 0.3, 0.4, 1.1}, 9});
  for (int i = 0; i < 150; ++i) ASSERT_TRUE(tick()) << controller.log();
  EXPECT_GT(world.least_room_m, 0.0) << "touched";
  EXPECT_GT(world.position.x(), x + 0.3) << "there is room beside it: " << statuses.back().reason();
}

// F5 -----------------------------------------------------------------------------------------------------------------

TEST_F(LockstepController, NumbersThatAreNoneStopTheRobotAndNeverComeOut) {
  get_going();
  int turn = 0;
  world.spoil_pose = [&](auto& m) {
    switch (turn++ % 4) {
      case 0: m.pose().pose().position().x(kNaN); break;
      case 1: m.pose().pose().orientation().w(std::numeric_limits<double>::infinity()); break;
      case 2: m.pose().pose().orientation({}); break;
      default: m.pose().pose().position().y(1e300);
    }
  };
  EXPECT_LE(ticks_until(true, 2.0), kStopWithin_s);
  world.spoil_pose = nullptr;
  EXPECT_LE(ticks_until(false, 2.0), 0.5);
  world.spoil_view = [&](auto& depth, auto& info) {
    depth.encoding("32FC1");
    depth.step(4 * depth.width());
    depth.data().assign(static_cast<std::size_t>(depth.step()) * depth.height(), 0xff);  // NaN everywhere
    if (turn++ % 2 == 0) info.k()[0] = kNaN;
  };
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << controller.log();
  world.spoil_view = nullptr;
  world.spoil_map = [](auto& m) { m.info().resolution(std::numeric_limits<float>::quiet_NaN()); };
  EXPECT_LE(ticks_until(true, 3.0), kStopWithin_s) << "a map that cannot be used is none";
  world.spoil_map = nullptr;
  EXPECT_LE(ticks_until(false, 2.0), 1.5);
  world.send_path({{0, 0}, {kNaN, 0}});
  ASSERT_TRUE(tick());
  EXPECT_TRUE(is_zero(commands.back()));
  EXPECT_EQ(statuses.back().reason(), "path refused: pose has numbers that are not finite");
  for (const auto& command : commands) EXPECT_TRUE(is_finite(command));
  EXPECT_TRUE(wait_until([&] {
    return count_of("pose dropped") > 0 && count_of("depth dropped") > 0 && count_of("grid dropped") > 0 &&
           count_of("path dropped") > 0;
  })) << controller.log();
}

TEST_F(LockstepController, RefusesWhatIsOfAnotherFrame) {
  world.spoil_pose = [](auto& m) { m.header().frame_id("odom"); };
  world.send_path({{0, 0}, {3, 0}});
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(tick());
    EXPECT_TRUE(is_zero(commands.back()));
  }
  EXPECT_TRUE(wait_until([&] { return count_of("pose dropped: it is not of base_link in map") > 0; }));
  world.spoil_pose = nullptr;
  world.spoil_map = [](auto& m) { m.header().frame_id("odom"); };
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(tick());
  EXPECT_TRUE(is_zero(commands.back())) << "a map in another frame is none";
  EXPECT_TRUE(wait_until([&] { return count_of("grid dropped: it is not in map") > 0; }));
}

TEST_F(LockstepController, LastWordAfterSigtermIsZero) {
  get_going();
  ASSERT_FALSE(is_zero(commands.back()));
  const std::size_t before = commands.size();
  controller.signal(SIGTERM);
  EXPECT_TRUE(wait_until([&] { return commands.size() > before; })) << controller.log();
  EXPECT_EQ(controller.wait(), 0) << controller.log();
  EXPECT_TRUE(is_zero(commands.back()));
}

// By the wall clock ---------------------------------------------------------------------------------------------------

class FreeController : public ControllerContract {
 protected:
  using Clock = std::chrono::steady_clock;

  explicit FreeController(const std::vector<std::string>& options = {}) : ControllerContract(options) {}

  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(controller)) << controller.log();
    world.send_path({{0, 0}, {3, 0}, {6, 0}});
    // At the rate of the camera until it drives.
    ASSERT_TRUE(frames_until([&] { return !commands.empty() && commands.back().linear().x() > 0.3; }, {}))
        << (statuses.empty() ? "no status" : statuses.back().reason()) << controller.log();
  }
  /// A frame per period; true when the condition holds before ten seconds are over.
  bool frames_until(const std::function<bool()>& condition, const Speaking& who) {
    for (int i = 0; i < 10 * kRate_hz; ++i) {
      world.publish(who);
      if (wait_until(condition, Seconds(kPeriod_s))) return true;
    }
    return false;
  }
  /// From the last whole frame until it stands still, when then only `who` speaks [s]. In between it has to continue. A
  /// silence counts only if commands came all the time: else the machine was busy.
  double seconds_until_still(
      const Speaking& who, const std::function<void()>& spoil = [] {}) {
    for (int silence = 0; silence < kMostSilences; ++silence) {
      world.publish({});
      const auto last = Clock::now();
      auto heard = last;
      std::size_t count = commands.size();
      double longest_gap_s = 0.0;
      spoil();
      const auto is_still = [&] {
        const auto now = Clock::now();
        longest_gap_s = std::max(longest_gap_s, std::chrono::duration<double>(now - heard).count());
        if (std::exchange(count, commands.size()) != commands.size()) heard = now;
        return is_zero(commands.back());
      };
      EXPECT_TRUE(frames_until(is_still, who)) << controller.log();
      const double stopped_s = std::chrono::duration<double>(Clock::now() - last).count();
      world.spoil_pose = {};
      world.spoil_view = {};
      EXPECT_TRUE(frames_until([&] { return !is_zero(commands.back()); }, {})) << "and continues with all";
      if (longest_gap_s > kLongestGap_s) continue;
      std::cout << "figure: still after " << std::lround(1e3 * stopped_s) << " ms\n";
      return stopped_s;
    }
    ADD_FAILURE() << "commands come less than " << 1.0 / kLongestGap_s << " times a second: the machine is too busy";
    return 0.0;
  }
  /// Sets the clock of all stamps by `step`; true when it drives on without a stop. A stop counts only if frames and
  /// commands came all the time: else the machine was busy.
  bool drives_on_after(time::Duration step) {
    for (int attempt = 0; attempt < kMostSilences; ++attempt) {
      world.clock = {world.clock.nanoseconds + step.nanoseconds};
      const std::size_t before = commands.size();
      const double longest_delay_s = drive_for_ten_frames();
      const auto from = commands.begin() + static_cast<std::ptrdiff_t>(before);
      const bool has_stopped = from == commands.end() || std::any_of(from, commands.end(), is_zero);
      if (!has_stopped || longest_delay_s <= kLongestDelay_s) return !has_stopped;
      EXPECT_TRUE(frames_until([&] { return !is_zero(commands.back()); }, {})) << controller.log();
    }
    ADD_FAILURE() << "the machine is too busy";
    return false;
  }
  /// Returns by how much a frame or a command came late at most [s].
  double drive_for_ten_frames() {
    double longest_s = 0.0;
    auto heard = Clock::now();
    for (int frame = 0; frame < 10; ++frame) {
      const auto sent = Clock::now();
      world.position.x() += 0.01;
      world.publish({});
      std::size_t count = commands.size();
      wait_until(
          [&] {
            if (std::exchange(count, commands.size()) != commands.size()) heard = Clock::now();
            longest_s = std::max(longest_s, std::chrono::duration<double>(Clock::now() - heard).count() - 0.05);
            return false;
          },
          Seconds(kPeriod_s));
      longest_s = std::max(longest_s, std::chrono::duration<double>(Clock::now() - sent).count() - kPeriod_s);
    }
    return longest_s;
  }
  static constexpr double kLongestDelay_s = 0.03;  // a frame less, and two that are so late, are no reason to stop
  static constexpr int kMostSilences = 10;
  static constexpr double kLongestGap_s = 0.1;
};

TEST_F(FreeController, CommandsComeAtTwentyHertz) {
  const std::size_t before = commands.size();
  int frames = 0;
  ASSERT_TRUE(frames_until([&] { return commands.size() >= before + 20; }, {}));
  const auto began = Clock::now();
  const std::size_t from = commands.size();
  ASSERT_TRUE(frames_until([&] { return commands.size() >= from + 40; }, {})) << frames;
  const double took_s = std::chrono::duration<double>(Clock::now() - began).count();
  EXPECT_GT(took_s, 40 / 20.5);
  EXPECT_LT(took_s, 40 / 10.0);
}

TEST_F(FreeController, IsSilentWithoutAPathAndObeysAnOperator) {
  auto& teleop = context.advertise(topics::kTeleop);
  ASSERT_TRUE(wait_until([&] { return teleop.matched() > 0; })) << controller.log();
  world.send_path({});
  const auto is_idle = [&] { return statuses.back().state() == Constants::STATE_IDLE && is_zero(commands.back()); };
  ASSERT_TRUE(frames_until(is_idle, {})) << controller.log();
  const std::size_t before = commands.size();
  for (int frame = 0; frame < kRate_hz; ++frame) {
    world.publish({});
    EXPECT_FALSE(wait_until([&] { return commands.size() > before; }, Seconds(kPeriod_s))) << "it is silent";
  }
  Command wanted;
  wanted.linear().x(0.2);
  const auto drives = [&] {
    teleop.publish(wanted);
    return commands.size() > before && commands.back().linear().x() > 0.19;
  };
  ASSERT_TRUE(frames_until(drives, {})) << statuses.back().reason() << controller.log();
  EXPECT_LE(commands.back().linear().x(), 0.2);
  ASSERT_TRUE(frames_until(is_idle, {})) << "the operator has fallen silent";
  wanted.linear().x(kNaN);
  teleop.publish(wanted);
  EXPECT_TRUE(frames_until([&] { return count_of("operator's velocity dropped") > 0; }, {})) << controller.log();
}

class FreeControllerWithout : public FreeController, public ::testing::WithParamInterface<Speaking> {};

TEST_P(FreeControllerWithout, StandsStillWithin300MillisecondsOfTheLastWord) {
  EXPECT_LT(seconds_until_still(GetParam()), kStopWithin_s);
}

INSTANTIATE_TEST_SUITE_P(Each, FreeControllerWithout,
                         ::testing::Values(Speaking{.camera = false}, Speaking{.pose = false}, Speaking{.map = false},
                                           Speaking{.planner = false}),
                         [](const auto& test) {
                           return !test.param.camera ? "Camera"
                                  : !test.param.pose ? "Pose"
                                  : !test.param.map  ? "Map"
                                                     : "Planner";
                         });

TEST_F(FreeController, StandsStillWhenAllFallSilentAtOnce) {
  EXPECT_LT(seconds_until_still({.camera = false, .pose = false, .map = false, .planner = false}), kStopWithin_s);
}

TEST_F(FreeController, ATurnStandsStillWithin300MillisecondsOfTheLastImageOrWordOfThePlanner) {
  for (const Speaking& who : {Speaking{.pose = false, .planner = false}, Speaking{.camera = false, .pose = false}}) {
    world.send_path({});
    world.send_turn({2.0, 4.0, 6.0, 8.0, 10.0});
    const auto turns = [&] { return commands.back().angular().z() > 0.0 && commands.back().linear().x() == 0.0; };
    ASSERT_TRUE(frames_until(turns, {.pose = false})) << statuses.back().reason() << controller.log();
    EXPECT_LT(seconds_until_still(who), kStopWithin_s);
  }
}

TEST_F(FreeController, StandsStillWhenTheStampsStandStill) {
  const auto stand_still = [&] {
    const auto stuck = messages::to_message(world.stamp);
    world.spoil_pose = [stuck](auto& m) { m.header().stamp(stuck); };
    world.spoil_view = [stuck](auto& depth, auto& info) {
      depth.header().stamp(stuck);
      info.header().stamp(stuck);
    };
  };
  EXPECT_LT(seconds_until_still({}, stand_still), kStopWithin_s);
}

TEST_F(FreeController, DrivesOnWhenTheClockIsSetAndStillStopsWhenNothingComes) {
  for (const double step_s : {36'000.0, -5.0, -1800.0, 5.0}) {
    SCOPED_TRACE(step_s);
    EXPECT_TRUE(drives_on_after(time::Duration::from_seconds(step_s))) << statuses.back().reason() << controller.log();
  }
  EXPECT_TRUE(wait_until([&] { return count_of("depth: the clock of its source was set") >= 4; })) << controller.log();
  EXPECT_TRUE(frames_until([&] { return !is_zero(commands.back()); }, {})) << controller.log();
  EXPECT_LT(seconds_until_still({.camera = false, .pose = false, .map = false, .planner = false}), kStopWithin_s);
  EXPECT_LT(seconds_until_still({.pose = false}), kStopWithin_s);
}

class FreeControllerWithOdometry : public FreeController {
 protected:
  FreeControllerWithOdometry() : FreeController({"--set", "controller.publish_odometry=true"}) {}
  time::Time stamp_of(std::size_t reading) const { return messages::from_message(readings[reading].header().stamp()); }
};

TEST_F(FreeControllerWithOdometry, HasTheCameraClockAndNoMotionThatWasNot) {
  for (const std::int64_t step_s : {0, 10, -10}) {
    world.clock = {world.clock.nanoseconds + step_s * 1'000'000'000};
    ASSERT_TRUE(frames_until(
        [&] { return !readings.empty() && abs(stamp_of(readings.size() - 1) - world.stamp).seconds() < 1.0; }, {}));
    readings.clear();
    commands.clear();
    for (int i = 0; i < 3; ++i) drive_for_ten_frames();
    ASSERT_GT(readings.size(), 10U);
    double fastest_m_s = 0.0;
    for (const auto& command : commands) fastest_m_s = std::max(fastest_m_s, command.linear().x());
    for (std::size_t i = 1; i < readings.size(); ++i) {
      ASSERT_GT(stamp_of(i), stamp_of(i - 1)) << "after a step of " << step_s << " s";
      EXPECT_LT(abs(stamp_of(i) - world.stamp).seconds(), 5.0);
    }
    const double driven_m =
        readings.back().pose().pose().position().x() - readings.front().pose().pose().position().x();
    const double seconds = (stamp_of(readings.size() - 1) - stamp_of(0)).seconds();
    EXPECT_GT(driven_m, 0.3 * fastest_m_s * seconds);
    EXPECT_LT(driven_m, 1.1 * fastest_m_s * seconds) << "after a step of " << step_s << " s";
  }
}

TEST_F(FreeController, StandsStillWhileThePoseHasAnotherClock) {
  const auto other_clock = [&] {
    world.spoil_pose = [](auto& m) {
      const auto stamp = messages::from_message(m.header().stamp());
      m.header().stamp(messages::to_message(stamp + time::Duration::from_seconds(3600.0)));
    };
  };
  EXPECT_LT(seconds_until_still({}, other_clock), kStopWithin_s);
}

TEST_F(FreeController, WhatWasInDoubtIsForgottenInLockStep) {
  constexpr time::Duration kOtherClock{3'600'000'000'000};
  world.clock = kOtherClock;
  world.publish({});
  const std::size_t later = commands.size() + 3;
  ASSERT_TRUE(wait_until([&] { return commands.size() >= later; })) << controller.log();
  {
    runtime::Context ticking({"test_ticks", participant_options("test_ticks")});
    runtime::LockstepDriver driver(ticking, {{"controller"}, 5.0, 30.0, "abort"}, [] {});
    const auto is_idle = [&] {
      ticking.executor().spin_once(std::chrono::milliseconds(2));
      return driver.state() == runtime::LockstepDriver::State::kIdle;
    };
    ASSERT_TRUE(wait_until(is_idle)) << controller.log();
    world.clock = {};
    world.publish({});
    driver.begin(world.stamp, false);
    ASSERT_TRUE(wait_until(is_idle)) << controller.log();
    ASSERT_TRUE(wait_until([&] { return count_of("depth dropped: waited when stamps went back") > 0; }));
  }
  world.clock = kOtherClock;
  const std::size_t before = commands.size();
  ASSERT_TRUE(frames_until([&] { return commands.size() > before && !is_zero(commands.back()); }, {}))
      << controller.log();
  world.spoil_pose = [](auto& m) { m.header().frame_id("odom"); };
  ASSERT_TRUE(frames_until([&] { return count_of("pose dropped: it is not of base_link in map") > 0; }, {}));
  EXPECT_EQ(count_of("the clock of its source was set"), 0U) << controller.log();
}

TEST(ControllerSetUp, KeysThatContradictEachOtherAreNamed) {
  const std::vector<std::pair<std::string, std::string>> contradictions{
      {"controller.local_map.min_height_m=1.2", "robot.obstacle_max_height_m"},
      {"controller.local_map.range_m=1.7", "controller.fan.length_m"},
      {"controller.progress_timeout_s=3.9", "robot.max_turn_rate_rad_s"}};
  for (const auto& [setting, key] : contradictions) {
    ChildProcess controller(kController, {"--set", setting});
    EXPECT_EQ(controller.wait(), 2) << setting << controller.log();
    EXPECT_THAT(controller.log(), HasSubstr(key)) << setting;
  }
}

}  // namespace
}  // namespace lapis::test
