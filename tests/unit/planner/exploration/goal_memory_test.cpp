#include "planner/core/exploration/goal_memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const Eigen::Vector2d kTarget{3.0, -2.0};

time::Time after(double seconds) { return time::Time::from_seconds(seconds); }

TEST(GoalMemory, LeavesAFailureAloneUntilItExpires) {
  GoalMemory memory({.expiry_s = 30.0});
  EXPECT_THAT(memory.left_alone(after(0.0)), IsEmpty());
  memory.add_failure(kTarget, after(10.0));
  EXPECT_THAT(memory.left_alone(after(39.0)), ElementsAre(kTarget));
  EXPECT_THAT(memory.left_alone(after(41.0)), IsEmpty());
}

TEST(GoalMemory, LeavesItAloneForGoodAfterThree) {
  GoalMemory memory({.max_failures = 3});
  for (const double when : {0.0, 100.0, 200.0}) memory.add_failure(kTarget, after(when));
  EXPECT_THAT(memory.left_alone(after(1e6)), ElementsAre(kTarget));
  EXPECT_FALSE(memory.forgive(after(201.0)));
  memory.clear();
  EXPECT_THAT(memory.left_alone(after(1e6)), IsEmpty());
}

TEST(GoalMemory, ForgivesWhatHasNotFailedForGood) {
  GoalMemory memory({});
  memory.add_failure(kTarget, after(0.0));
  EXPECT_TRUE(memory.forgive(after(1.0)));
  EXPECT_THAT(memory.left_alone(after(1.0)), IsEmpty());
  EXPECT_FALSE(memory.forgive(after(1.0))) << "nothing is left to forgive";
}

TEST(GoalMemory, WhatLiesNearIsOneTarget) {
  GoalMemory memory({.radius_m = 0.75, .max_failures = 2});
  memory.add_failure(kTarget, after(0.0));
  memory.add_failure(kTarget + Eigen::Vector2d(0.5, 0.5), after(0.0));
  EXPECT_THAT(memory.left_alone(after(1e6)), ElementsAre(kTarget));
  memory.add_failure(kTarget + Eigen::Vector2d(0.0, -0.8), after(0.0));
  EXPECT_THAT(memory.left_alone(after(1e6)), ElementsAre(kTarget)) << "one failure elsewhere expires";
}

// Else it could fail as often again for each target beside it that has failed before.
TEST(GoalMemory, AFailureCountsForAllTargetsThatAreNear) {
  GoalMemory memory({.radius_m = 0.75, .max_failures = 3});
  for (const double x_m : {-0.7, 0.7, 0.0, -0.1, 0.1}) memory.add_failure({x_m, 0.0}, after(0.0));
  EXPECT_THAT(memory.left_alone(after(1e6)),
              UnorderedElementsAre(Eigen::Vector2d{-0.7, 0.0}, Eigen::Vector2d{0.0, 0.0}, Eigen::Vector2d{0.7, 0.0}));
}

TEST(GoalMemory, LeavingAloneIsNoFailure) {
  GoalMemory memory({.expiry_s = 10.0, .max_failures = 1});
  memory.leave_alone(kTarget, after(2.0));
  EXPECT_THAT(memory.left_alone(after(1.0)), ElementsAre(kTarget));
  EXPECT_THAT(memory.left_alone(after(3.0)), IsEmpty());
}

}  // namespace
}  // namespace lapis::planner
