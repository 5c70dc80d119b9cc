#include "common/time/stamp_judge.hpp"

#include <gtest/gtest.h>

namespace lapis::time {
namespace {

using Verdict = StampJudge::Verdict;
using std::chrono::milliseconds;

/// A camera at 10 Hz, of which frame i arrives at i / 10 s.
class Camera {
 public:
  Verdict send(int frame, Duration clock = {}) {
    const auto arrival = Arrival{} + milliseconds(100 * frame + 1'000'000);
    return judge.judge(stamp(frame) + clock, arrival);
  }
  static Time stamp(int frame) { return Time::from_seconds(5000.0 + 0.1 * frame); }

  StampJudge judge;
};

constexpr Duration kHour{3'600'000'000'000};
constexpr Duration kBack{-5'000'000'000};

TEST(StampJudge, DisorderAndPausesFit) {
  Camera camera;
  for (const int frame : {0, 1, 3, 2, 4}) EXPECT_EQ(camera.send(frame), Verdict::kFits) << frame;
  EXPECT_EQ(camera.send(5000), Verdict::kFits) << "after a pause of 500 s";
}

TEST(StampJudge, RecordingWithAGapMayBePlayedTenTimesAsFast) {
  StampJudge judge;
  EXPECT_EQ(judge.judge(Time::from_seconds(0.0), {}), Verdict::kFits);
  EXPECT_EQ(judge.judge(Time::from_seconds(60.0), Arrival{} + milliseconds(6000)), Verdict::kFits);
  EXPECT_EQ(judge.judge(Time::from_seconds(60.9), Arrival{} + milliseconds(6001)), Verdict::kFits);
}

TEST(StampJudge, OneWrongStampIsAStray) {
  for (const Duration wrong : {kHour, kBack, Duration{5'000'000'000}, Duration{-kHour.nanoseconds}}) {
    Camera camera;
    camera.send(0);
    EXPECT_EQ(camera.send(1, wrong), Verdict::kDoubtful);
    EXPECT_EQ(camera.send(2), Verdict::kStray);
    EXPECT_EQ(camera.send(3), Verdict::kFits);
  }
}

TEST(StampJudge, SeveralWrongStampsThatDoNotFollowEachOtherAreStrays) {
  Camera camera;
  camera.send(0);
  EXPECT_EQ(camera.send(1, kHour), Verdict::kDoubtful);
  EXPECT_EQ(camera.send(2, kBack), Verdict::kDoubtful);
  EXPECT_EQ(camera.send(3, kHour), Verdict::kDoubtful);
  EXPECT_EQ(camera.send(4), Verdict::kStray);
}

TEST(StampJudge, TheSameWrongStampTwiceIsNoClock) {
  Camera camera;
  camera.send(0);
  EXPECT_EQ(camera.send(1, kHour), Verdict::kDoubtful);
  EXPECT_EQ(camera.judge.judge(Camera::stamp(1) + kHour, Arrival{} + milliseconds(1'000'150)), Verdict::kDoubtful);
  EXPECT_EQ(camera.send(2), Verdict::kStray);
}

TEST(StampJudge, ClockThatWasSetIsFollowedFromTheSecondFrameOn) {
  for (const Duration step : {kHour, kBack, Duration{5'000'000'000}, Duration{-kHour.nanoseconds}}) {
    Camera camera;
    for (const int frame : {0, 1, 2}) camera.send(frame);
    EXPECT_EQ(camera.send(3, step), Verdict::kDoubtful);
    EXPECT_EQ(camera.send(4, step), Verdict::kStepped);
    EXPECT_EQ(camera.judge.step(), step);
    EXPECT_EQ(camera.send(5, step), Verdict::kFits);
    EXPECT_EQ(camera.send(6), Verdict::kDoubtful);
    EXPECT_EQ(camera.send(7), Verdict::kStepped);
    EXPECT_EQ(camera.judge.step(), Duration{-step.nanoseconds});
  }
}

}  // namespace
}  // namespace lapis::time
