#include "common/logging/rate_limit.hpp"

#include <gtest/gtest.h>

namespace lapis::logging {
namespace {

using std::chrono::milliseconds;

TEST(RateLimit, LetsOnePerPeriodThroughAndCountsTheRest) {
  RateLimit limit(milliseconds(1000));
  const RateLimit::Clock::time_point start{};
  EXPECT_EQ(limit.pass("depth", start), 0u);
  for (int i = 1; i < 10; ++i) EXPECT_FALSE(limit.pass("depth", start + milliseconds(100 * i)));
  EXPECT_EQ(limit.pass("depth", start + milliseconds(1000)), 9u);
  EXPECT_FALSE(limit.pass("depth", start + milliseconds(1999)));
  EXPECT_EQ(limit.pass("depth", start + milliseconds(5000)), 1u);
}

TEST(RateLimit, KeysDoNotHoldEachOtherBack) {
  RateLimit limit(milliseconds(1000));
  const RateLimit::Clock::time_point start{};
  EXPECT_TRUE(limit.pass("depth", start));
  EXPECT_TRUE(limit.pass("color", start));
  EXPECT_FALSE(limit.pass("depth", start));
}

TEST(RateLimit, NewKeysCountAsOneWhenThereAreMany) {
  RateLimit limit(milliseconds(1000));
  const RateLimit::Clock::time_point start{};
  std::size_t passed = 0;
  for (int i = 0; i < 10'000; ++i) passed += limit.pass("frame " + std::to_string(i), start) ? 1 : 0;
  EXPECT_EQ(passed, RateLimit::kMostKeys);
  EXPECT_FALSE(limit.pass("frame 0", start));
  EXPECT_EQ(limit.pass("frame 0", start + milliseconds(1000)), 1u);
}

}  // namespace
}  // namespace lapis::logging
