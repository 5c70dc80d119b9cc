#include "controller/core/watchdog.hpp"

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

using time::Duration;
using time::Time;

constexpr Time kStart{5'000'000'000'000};
Time at(double seconds) { return kStart + Duration::from_seconds(seconds); }
Time stamp(double seconds) { return Time::from_seconds(100.0 + seconds); }  // of another clock

/// All inputs, at this time.
void note_all(Watchdog& dog, double seconds) {
  for (const Input input : {Input::kCamera, Input::kPose, Input::kView, Input::kMap}) {
    dog.note(input, at(seconds), stamp(seconds));
  }
  dog.note(Input::kPlanner, at(seconds));
}

TEST(Watchdog, NamesWhatHasNeverCome) {
  Watchdog dog({});
  EXPECT_EQ(dog.stale(at(0)), Input::kCamera);
  EXPECT_EQ(dog.describe(Input::kCamera), "no depth image yet");
  note_all(dog, 0.0);
  EXPECT_EQ(dog.stale(at(0)), std::nullopt);
}

TEST(Watchdog, EachInputIsOldAfterItsOwnTime) {
  const std::pair<Input, double> limits[] = {
      {Input::kCamera, 0.2}, {Input::kPose, 0.3}, {Input::kView, 0.2}, {Input::kMap, 1.0}, {Input::kPlanner, 2.0}};
  for (const auto& [silent, limit_s] : limits) {
    Watchdog dog({.pose_timeout_s = 0.3, .camera_timeout_s = 0.2, .map_timeout_s = 1.0, .planner_timeout_s = 2.0});
    note_all(dog, 0.0);
    // The silent one's stamp is left behind; the others come at 50 Hz.
    for (double t = 0.02; t < limit_s + 0.2; t += 0.02) {
      for (const Input input : {Input::kCamera, Input::kPose, Input::kView, Input::kMap}) {
        if (input != silent) dog.note(input, at(t), stamp(t));
      }
      if (silent != Input::kPlanner) dog.note(Input::kPlanner, at(t));
      if (t < limit_s - 1e-6) {
        EXPECT_EQ(dog.stale(at(t)), std::nullopt) << t;
      }
      if (t > limit_s + 0.021) {
        EXPECT_EQ(dog.stale(at(t)), silent) << t;
      }
    }
  }
}

TEST(Watchdog, LagOfTheStampsCountsHoweverOftenSomethingArrives) {
  Watchdog dog({});
  for (double t = 0.0; t < 1.0; t += 0.05) {
    note_all(dog, t);
    dog.note(Input::kPose, at(t), stamp(t - 0.35));
    EXPECT_EQ(dog.stale(at(t)), Input::kPose);
  }
}

TEST(Watchdog, TheSameStampAgainIsNothingNew) {
  Watchdog dog({});
  note_all(dog, 0.0);
  for (double t = 0.0; t < 0.25; t += 0.05) {  // everybody keeps sending, but the clock stands still
    for (const Input input : {Input::kCamera, Input::kPose, Input::kView, Input::kMap}) {
      dog.note(input, at(t), stamp(0.0));
    }
    dog.note(Input::kPlanner, at(t));
  }
  EXPECT_EQ(dog.stale(at(0.21)), std::nullopt);
  EXPECT_EQ(dog.stale(at(0.23)), Input::kCamera);
}

TEST(Watchdog, AfterAClockHasJumpedEverythingHasToComeAnew) {
  for (const double jump_s : {-50.0, 3600.0}) {
    Watchdog dog({});
    note_all(dog, 0.0);
    EXPECT_NE(dog.stale(at(jump_s)), std::nullopt);
    dog.note(Input::kCamera, at(jump_s), stamp(jump_s));
    EXPECT_EQ(dog.stale(at(jump_s)), Input::kPose) << "the pose is from before";
    note_all(dog, jump_s);
    EXPECT_EQ(dog.stale(at(jump_s)), std::nullopt);
  }
}

}  // namespace
}  // namespace lapis::controller
