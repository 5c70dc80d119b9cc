#include "common/time/stamp_tolerance.hpp"

#include <gtest/gtest.h>

namespace lapis::time {
namespace {

constexpr std::int64_t kMs = 1'000'000;

Time at(std::int64_t ms) { return {ms * kMs}; }

TEST(StampTolerance, IsThatWhichIsGiven) {
  StampTolerance tolerance(Duration{7 * kMs});
  EXPECT_EQ(tolerance.of(at(0), std::nullopt), Duration{7 * kMs});
  tolerance.note(at(0));
  tolerance.note(at(100));
  EXPECT_EQ(tolerance.of(at(200), at(300)), Duration{7 * kMs});
}

TEST(StampTolerance, IsUnknownUntilThereAreTwoMessages) {
  const StampTolerance tolerance(Duration{});
  EXPECT_EQ(tolerance.of(at(0), std::nullopt), std::nullopt);
  EXPECT_EQ(tolerance.of(at(0), at(50)), Duration{30 * kMs});
}

TEST(StampTolerance, FollowsThePeriodEvenWhereMessagesAreMissing) {
  StampTolerance tolerance(Duration{});
  std::int64_t now = 0;
  for (const int step : {10, 10, 20, 10, 30, 10, 20, 10, 20}) tolerance.note(at(now += step));
  EXPECT_EQ(tolerance.of(at(now + 10), at(now + 500)), Duration{6 * kMs});
}

TEST(StampTolerance, IsAtMostThatOfFiveHertz) {
  StampTolerance tolerance(Duration{});
  EXPECT_EQ(tolerance.of(at(0), at(1000)), StampTolerance::kLargest);
  tolerance.note(at(0));
  tolerance.note(at(1000));
  EXPECT_EQ(tolerance.of(at(2000), std::nullopt), StampTolerance::kLargest);
}

TEST(StampTolerance, BeginsAnewWhereStampsJump) {
  StampTolerance tolerance(Duration{});
  tolerance.note(at(5000));
  tolerance.note(at(5010));
  tolerance.note(at(100));  // back
  EXPECT_EQ(tolerance.of(at(200), std::nullopt), std::nullopt);
  tolerance.note(at(200));
  EXPECT_EQ(tolerance.of(at(300), std::nullopt), Duration{60 * kMs});
  tolerance.begin_anew();
  EXPECT_EQ(tolerance.of(at(300), std::nullopt), std::nullopt);
}

}  // namespace
}  // namespace lapis::time
