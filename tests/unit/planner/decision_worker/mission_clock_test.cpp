#include "planner/mission_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace lapis::planner {
namespace {

constexpr time::Duration kHour{3'600'000'000'000};
constexpr time::Duration kFiveSecondsBack{-5'000'000'000};

/// slam's frames at 10 Hz.
class MissionFrames {
 public:
  static time::Time stamp(int frame) { return time::Time::from_seconds(5000.0 + 0.1 * frame); }
  /// Frame by a clock that was set by `set` altogether.
  std::optional<time::Duration> send(int frame, time::Duration set = {}) {
    return clock.advance(stamp(frame) + set, time::Arrival{} + std::chrono::milliseconds(100 * frame + 1'000'000));
  }

  MissionClock clock;
};

TEST(MissionClock, IsThatOfTheFrames) {
  MissionFrames frames;
  for (const int frame : {0, 1, 2, 700}) {
    EXPECT_FALSE(frames.send(frame));
    EXPECT_EQ(frames.clock.stamp(), MissionFrames::stamp(frame));
    EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(frame));
  }
}

TEST(MissionClock, GoesOnWhenTheClockIsSet) {
  for (const time::Duration step : {kHour, kFiveSecondsBack, -kHour}) {
    MissionFrames frames;
    for (const int frame : {0, 1}) frames.send(frame);
    EXPECT_FALSE(frames.send(2, step)) << "one frame may be a stray";
    EXPECT_EQ(frames.clock.stamp(), MissionFrames::stamp(1));
    EXPECT_EQ(frames.send(3, step), step);
    EXPECT_EQ(frames.clock.stamp(), MissionFrames::stamp(3) + step);
    EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(3));
    EXPECT_FALSE(frames.send(4, step));
    EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(4));
    EXPECT_EQ(frames.clock.of(MissionFrames::stamp(2) + step), MissionFrames::stamp(2));
    EXPECT_FALSE(frames.send(5));
    EXPECT_EQ(frames.send(6), -step) << "set a second time";
    EXPECT_EQ(frames.clock.stamp(), MissionFrames::stamp(6));
    EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(6));
  }
}

TEST(MissionClock, StrayIsLeftOut) {
  MissionFrames frames;
  frames.send(0);
  EXPECT_FALSE(frames.send(1, kHour));
  EXPECT_FALSE(frames.send(2));
  EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(2));
}

TEST(MissionClock, WhatWasInDoubtIsForgottenInLockStep) {
  MissionFrames frames;
  frames.send(0);
  frames.send(1, kHour);
  frames.clock.believe(MissionFrames::stamp(2) + kHour);
  EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(2) + kHour);
  EXPECT_FALSE(frames.send(3, kHour)) << "free again";
  EXPECT_EQ(frames.clock.now(), MissionFrames::stamp(3) + kHour);
}

}  // namespace
}  // namespace lapis::planner
