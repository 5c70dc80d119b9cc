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

}  // namespace
}  // namespace lapis::logging
