#include "common/runtime/status.hpp"

#include <gtest/gtest.h>

namespace lapis::runtime {
namespace {

TEST(Status, StartsWell) {
  Status status;
  EXPECT_EQ(status.level(), Status::Level::kOk);
  EXPECT_EQ(status.message(), "running");
  EXPECT_FALSE(status.take_change());
}

TEST(Status, ChangeOfLevelIsReportedOnce) {
  Status status;
  status.set(Status::Level::kWarn, "no camera");
  EXPECT_TRUE(status.take_change());
  EXPECT_FALSE(status.take_change());
  status.set(Status::Level::kWarn, "no depth");
  EXPECT_FALSE(status.take_change());
  EXPECT_EQ(status.message(), "no depth");
  status.set(Status::Level::kOk, "running");
  EXPECT_TRUE(status.take_change());
}

TEST(Status, CountersAddUp) {
  Status status;
  EXPECT_EQ(status.counter("dropped"), 0u);
  status.count("dropped");
  status.count("dropped", 4);
  EXPECT_EQ(status.counter("dropped"), 5u);
  EXPECT_EQ(status.counters().size(), 1u);
}

// Foreign text may become part of a key, so a flood of names must not grow without end.
TEST(Status, NewCountersShareOneWhenThereAreMany) {
  Status status;
  status.count("dropped");
  for (int i = 0; i < 10'000; ++i) status.count("frame " + std::to_string(i));
  status.count("dropped");
  EXPECT_EQ(status.counters().size(), Status::kMostCounters);
  EXPECT_EQ(status.counter("dropped"), 2u);
  EXPECT_EQ(status.counter("frame 0"), 1u);
  EXPECT_EQ(status.counter(Status::kOtherCounters), 10'001u - (Status::kMostCounters - 1));
}

TEST(Status, LongKeysAreCut) {
  Status status;
  status.count(std::string(1'000'000, 'x'));
  EXPECT_EQ(status.counters().begin()->first.size(), Status::kLongestKey);
}

}  // namespace
}  // namespace lapis::runtime
