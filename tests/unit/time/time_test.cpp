#include "common/time/time.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace lapis::time {
namespace {

TEST(Time, DecimalSecondsKeepTheirDigits) {
  EXPECT_EQ(Time::from_seconds(0.033333).nanoseconds, 33333000);
  EXPECT_EQ(Time::from_seconds(-1.5).nanoseconds, -1500000000);
  EXPECT_EQ(to_string(Time{12033333000}), "12.033333000");
  EXPECT_EQ(to_string(Time{-500000000}), "-0.500000000");
  EXPECT_EQ(to_string(Time{std::numeric_limits<std::int64_t>::min()}), "-9223372036.854775808");
}

TEST(Time, DifferencesAndSumsAgree) {
  const Time a{1'000'000'000};
  const Time b{1'250'000'000};
  EXPECT_EQ((b - a).nanoseconds, 250'000'000);
  EXPECT_EQ(a + (b - a), b);
  EXPECT_EQ(abs(a - b), b - a);
  EXPECT_LT(a, b);
}

}  // namespace
}  // namespace lapis::time
