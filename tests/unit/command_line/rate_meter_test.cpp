#include "command_line/core/rate_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lapis::command_line {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

TEST(RateMeter, MeasuresRateGapsAndSizes) {
  RateMeter meter(100);
  for (const int at_ms : {0, 100, 190, 300}) meter.add(at_ms * kMillisecond, static_cast<std::size_t>(at_ms + 10));
  const auto rate = meter.rate();
  EXPECT_EQ(rate.messages, 4U);
  EXPECT_NEAR(rate.rate_hz, 10.0, 1e-9);
  EXPECT_NEAR(rate.shortest_gap_s, 0.09, 1e-12);
  EXPECT_NEAR(rate.longest_gap_s, 0.11, 1e-12);
  EXPECT_NEAR(rate.deviation_s, 0.01 * std::sqrt(2.0 / 3.0), 1e-12);
  EXPECT_NEAR(rate.mean_bytes, 157.5, 1e-9);
  EXPECT_NEAR(rate.bytes_per_s, 1575.0, 1e-6);
  EXPECT_EQ(rate.smallest_bytes, 10U);
  EXPECT_EQ(rate.largest_bytes, 310U);
}

TEST(RateMeter, ForgetsWhatIsBeforeItsWindow) {
  RateMeter meter(3);
  for (const int at_ms : {0, 1, 2, 1000, 2000, 3000}) meter.add(at_ms * kMillisecond, 1);
  EXPECT_NEAR(meter.rate().rate_hz, 1.0, 1e-9);
  EXPECT_EQ(meter.rate().messages, 6U);
  EXPECT_EQ(meter.rate().in_window, 3U);
}

TEST(RateMeter, HasNoRateOfOneMessage) {
  RateMeter meter(3);
  EXPECT_EQ(meter.rate().rate_hz, 0.0);
  meter.add(5, 7);
  EXPECT_EQ(meter.rate().rate_hz, 0.0);
  EXPECT_EQ(meter.rate().mean_bytes, 7.0);
  meter.add(5, 7);  // at the same instant
  EXPECT_EQ(meter.rate().rate_hz, 0.0);
}

}  // namespace
}  // namespace lapis::command_line
