#include "common/messages/time.hpp"

#include <gtest/gtest.h>

namespace lapis::messages {
namespace {

TEST(StampConversion, RoundTripsAlsoBeforeTheEpoch) {
  for (const std::int64_t ns : {0L, 1L, 999'999'999L, 1'000'000'000L, 1'700'000'000'123'456'789L, -1L, -1'000'000'000L,
                                -1'500'000'000L, 2'147'483'647'999'999'999L, -2'147'483'648'000'000'000L}) {
    const auto stamp = to_message(time::Time{ns});
    EXPECT_LT(stamp.nanosec(), 1'000'000'000u) << ns;
    EXPECT_EQ(from_message(stamp).nanoseconds, ns);
  }
}

}  // namespace
}  // namespace lapis::messages
