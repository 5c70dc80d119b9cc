#include "common/dds/pace.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kColorBytes = 691'200, kDepthBytes = 460'800, kLabelBytes = 230'400;
constexpr std::size_t kFrameBytes = kColorBytes + kDepthBytes + kLabelBytes;

/// A publisher of frames with a clock of its own.
class Frames {
 public:
  explicit Frames(const LargeSettings& settings) : pace(settings) {}

  /// Number of frames of a minute that are sent.
  int send_a_minute(int rate_hz) {
    int sent = 0;
    for (int i = 0; i < 60 * rate_hz; ++i) {
      now += std::chrono::microseconds(1'000'000 / rate_hz);
      if (!pace.has_room(now)) continue;
      for (const std::size_t bytes : {kColorBytes, kDepthBytes, kLabelBytes}) pace.add(bytes, now);
      ++sent;
    }
    return sent;
  }

  Pace pace;
  Pace::Clock::time_point now{};
};

TEST(Pace, TheDefaultCameraFitsANetwork) { EXPECT_EQ(Frames(kNetworkLink.large).send_a_minute(15), 60 * 15); }

TEST(Pace, OfWhatDoesNotFitSoManyFramesAreSentAsTheLinkCarries) {
  LargeSettings slow = kNetworkLink.large;
  slow.bytes_per_period = 13'000;  // 6.5 MB/s
  const double rate_hz = 6.5e6 / (1.1 * static_cast<double>(kFrameBytes));
  EXPECT_NEAR(Frames(slow).send_a_minute(15), 60 * rate_hz, 2);
}

TEST(Pace, WithoutALimitThereIsAlwaysRoom) {
  Frames frames(kLoopbackLink.large);
  EXPECT_FALSE(frames.pace.is_limited());
  EXPECT_EQ(frames.send_a_minute(100), 60 * 100);
}

TEST(Pace, ABurstOfTilesHoldsFramesUpUntilItIsSent) {
  Frames frames(kNetworkLink.large);
  for (int i = 0; i < 100; ++i) frames.pace.add(100'000, frames.now);  // 10 MB, 0.275 s at 40 MB/s
  EXPECT_FALSE(frames.pace.has_room(frames.now + milliseconds(100)));
  EXPECT_TRUE(frames.pace.has_room(frames.now + milliseconds(130)));
}

TEST(Pace, APauseIsNotSavedUp) {
  Frames frames(kNetworkLink.large);
  frames.pace.add(kFrameBytes, frames.now);
  frames.now += std::chrono::seconds(60);
  int at_once = 0;
  for (; frames.pace.has_room(frames.now); ++at_once) frames.pace.add(kFrameBytes, frames.now);
  EXPECT_EQ(at_once, 4) << "150 ms, in which three and a half frames are sent, and what begins there";
}

}  // namespace
}  // namespace lapis::dds
