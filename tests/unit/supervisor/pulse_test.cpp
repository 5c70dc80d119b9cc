// When a process counts as hung.
#include <gtest/gtest.h>

#include "supervisor/core/pulse.hpp"

namespace lapis::supervisor {
namespace {

constexpr double kUsual_s = 2.0;

TEST(Pulse, ProcessThatSaysNothingAfterItsStartHasTwentySeconds) {
  const Pulse pulse(100.0);
  EXPECT_FALSE(pulse.is_ready());
  EXPECT_FALSE(pulse.is_hung(119.9, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(120.1, kUsual_s));
}

TEST(Pulse, ReadyOneHangsWhenItIsSilentForLongerThanUsual) {
  Pulse pulse(100.0);
  pulse.hear(101.0, {Phase::kRunning, "", 0.0});
  EXPECT_TRUE(pulse.is_ready());
  EXPECT_FALSE(pulse.is_hung(102.9, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(103.1, kUsual_s));
  EXPECT_FALSE(pulse.is_hung(120.0, 30.0)) << "lock-step has more patience";
}

TEST(Pulse, AnnouncedWorkMayTakeItsTimeAndNoLonger) {
  Pulse pulse(100.0);
  pulse.hear(101.0, {Phase::kRunning, "saves the map", 60.0});
  EXPECT_EQ(pulse.activity(), "saves the map");
  EXPECT_FALSE(pulse.is_hung(160.9, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(161.1, kUsual_s));
  pulse.hear(130.0, {Phase::kRunning, "", 0.0});  // it is done
  EXPECT_TRUE(pulse.is_hung(132.1, kUsual_s));
}

TEST(Pulse, OneThatIsAskedToEndHasThatTimeAlthoughItContinuesSayingThatItRuns) {
  Pulse pulse(100.0);
  pulse.hear(101.0, {Phase::kRunning, "", 0.0});
  pulse.ask_to_end(102.0);
  pulse.hear(103.9, {Phase::kRunning, "", 0.0});
  EXPECT_FALSE(pulse.is_hung(103.95, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(104.1, kUsual_s));
  pulse.hear(104.0, {Phase::kEnding, "draws figures", 30.0});
  EXPECT_FALSE(pulse.is_hung(133.9, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(134.1, kUsual_s));
}

TEST(Pulse, OneThatWasBusyWhenItWasAskedToEndHasItsTimeAfterwards) {
  Pulse pulse(100.0);
  pulse.hear(101.0, {Phase::kRunning, "saves", 600.0});
  pulse.ask_to_end(102.0);
  pulse.hear(130.0, {Phase::kRunning, "", 0.0});
  EXPECT_FALSE(pulse.is_hung(131.9, kUsual_s));
  pulse.hear(131.9, {Phase::kRunning, "", 0.0});
  EXPECT_TRUE(pulse.is_hung(132.1, kUsual_s));
}

TEST(Pulse, SilenceWhileNobodyListenedSaysNothing) {
  Pulse pulse(100.0);
  pulse.hear(101.0, {Phase::kRunning, "", 0.0});
  pulse.ask_to_end(101.5);
  pulse.forgive(200.0);
  EXPECT_FALSE(pulse.is_hung(201.9, kUsual_s));
  EXPECT_TRUE(pulse.is_hung(202.1, kUsual_s));
}

}  // namespace
}  // namespace lapis::supervisor
