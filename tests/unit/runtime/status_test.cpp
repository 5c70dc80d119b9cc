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

}  // namespace
}  // namespace lapis::runtime
