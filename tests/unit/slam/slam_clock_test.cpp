#include "slam/slam_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace lapis::slam {
namespace {

constexpr time::Duration kHourAhead{3'600'000'000'000};
constexpr time::Duration kSetBack{-5'000'000'000};

/// Stamp of a camera frame at 10 Hz, and when it is processed.
time::Time frame_stamp(int frame) { return time::Time::from_seconds(5000.0 + 0.1 * frame); }
time::Arrival frame_arrival(int frame) { return time::Arrival{} + std::chrono::milliseconds(100 * frame + 1'000'000); }

/// A reading of the odometry in the middle between a frame and the next one.
std::optional<time::Time> read_after(const SlamClock& clock, int frame, time::Duration set) {
  const time::Time stamp = frame_stamp(frame) + time::Duration{50'000'000} + set;
  return clock.of_odometry(stamp, frame_arrival(frame) + std::chrono::milliseconds(50));
}
time::Time middle_after(int frame) { return frame_stamp(frame) + time::Duration{50'000'000}; }

TEST(SlamClock, WithoutAMapStampsAreAsTheyCome) {
  const SlamClock clock;
  for (const time::Duration set : {time::Duration{}, kHourAhead, kSetBack}) {
    EXPECT_EQ(read_after(clock, 0, set), middle_after(0) + set);
    EXPECT_EQ(clock.of(frame_stamp(0) + set), frame_stamp(0) + set);
  }
}

TEST(SlamClock, GoesOnWhenTheCameraIsSet) {
  for (const time::Duration step : {kHourAhead, -kHourAhead, kSetBack}) {
    SlamClock clock;
    EXPECT_EQ(clock.advance(frame_stamp(0), frame_arrival(0)), frame_stamp(0));
    clock.set(step);
    EXPECT_EQ(clock.now(), frame_stamp(0));
    for (const int frame : {1, 2}) {
      EXPECT_EQ(clock.advance(frame_stamp(frame) + step, frame_arrival(frame)), frame_stamp(frame));
      EXPECT_EQ(clock.now(), frame_stamp(frame));
      EXPECT_EQ(read_after(clock, frame, step), middle_after(frame));
    }
  }
}

TEST(SlamClock, GoesOnWhenTheCameraIsSetTwice) {
  SlamClock clock;
  clock.advance(frame_stamp(0), frame_arrival(0));
  clock.set(kHourAhead);
  clock.advance(frame_stamp(1) + kHourAhead, frame_arrival(1));
  const time::Duration both{kHourAhead.nanoseconds + kSetBack.nanoseconds};
  clock.set(kSetBack);
  EXPECT_EQ(clock.advance(frame_stamp(2) + both, frame_arrival(2)), frame_stamp(2));
  clock.set(-both);
  EXPECT_EQ(clock.advance(frame_stamp(3), frame_arrival(3)), frame_stamp(3));
}

TEST(SlamClock, OdometryDoesNotShiftItAndIsLeftOutUntilTheCameraIsSet) {
  for (const time::Duration step : {kHourAhead, kSetBack}) {
    SlamClock clock;
    clock.advance(frame_stamp(0), frame_arrival(0));
    EXPECT_FALSE(read_after(clock, 0, step));
    EXPECT_EQ(read_after(clock, 0, {}), middle_after(0)) << "of the clock as it was";
    clock.set(step);
    clock.advance(frame_stamp(1) + step, frame_arrival(1));
    EXPECT_EQ(read_after(clock, 1, step), middle_after(1));
    EXPECT_FALSE(read_after(clock, 1, {})) << "of the clock as it was";
  }
}

TEST(SlamClock, TimeDoesNotGoBackByTheJitterOfTheStep) {
  SlamClock clock;
  clock.advance(frame_stamp(0), frame_arrival(0));
  clock.set({kHourAhead.nanoseconds + 300'000'000});
  const time::Time first = clock.advance(frame_stamp(1) + kHourAhead, frame_arrival(1));
  EXPECT_GT(first, frame_stamp(0));
  EXPECT_EQ(clock.advance(frame_stamp(2) + kHourAhead, frame_arrival(2)) - first, frame_stamp(2) - frame_stamp(1));
}

TEST(SlamClock, ANewMapHasNoShift) {
  SlamClock clock;
  clock.advance(frame_stamp(0), frame_arrival(0));
  clock.set(kHourAhead);
  clock.advance(frame_stamp(1) + kHourAhead, frame_arrival(1));
  clock = {};
  EXPECT_EQ(clock.advance(frame_stamp(2) + kHourAhead, frame_arrival(2)), frame_stamp(2) + kHourAhead);
  EXPECT_EQ(read_after(clock, 2, kHourAhead), middle_after(2) + kHourAhead);
}

TEST(SlamClock, InLockStepTheShiftOfAFreeRunHoldsForBothStreams) {
  SlamClock clock;
  clock.advance(frame_stamp(0), frame_arrival(0));
  clock.set(kHourAhead);
  clock.advance(frame_stamp(1) + kHourAhead, frame_arrival(1));
  const auto long_after = frame_arrival(1) + std::chrono::hours(1);  // arrivals mean nothing
  EXPECT_EQ(clock.advance(frame_stamp(2) + kHourAhead, long_after), frame_stamp(2));
  EXPECT_EQ(clock.of(middle_after(2) + kHourAhead), middle_after(2));
}

}  // namespace
}  // namespace lapis::slam
