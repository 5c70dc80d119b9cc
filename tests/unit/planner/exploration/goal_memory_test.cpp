#include "planner/core/exploration/goal_memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const Eigen::Vector2d kTarget{3.0, -2.0};

/// Where and why.
std::vector<std::pair<Eigen::Vector2d, Rejection>> list(const std::vector<LeftAlone>& left_alone) {
  std::vector<std::pair<Eigen::Vector2d, Rejection>> targets;
  for (const LeftAlone& place : left_alone) targets.emplace_back(place.target_map, place.reason);
  return targets;
}

const auto kForNow = std::pair(kTarget, Rejection::kLeftAlone);
const auto kForGood = std::pair(kTarget, Rejection::kFailed);

std::pair<Eigen::Vector2d, Rejection> given_up(const Eigen::Vector2d& target_map) {
  return {target_map, Rejection::kFailed};
}

time::Time after(double seconds) { return time::Time::from_seconds(seconds); }

TEST(GoalMemory, LeavesAFailureAloneUntilItExpires) {
  GoalMemory memory({.expiry_s = 30.0});
  EXPECT_THAT(list(memory.left_alone(after(0.0), false)), IsEmpty());
  memory.add_failure(kTarget, {}, after(10.0));
  EXPECT_THAT(list(memory.left_alone(after(39.0), false)), ElementsAre(kForNow));
  EXPECT_THAT(list(memory.left_alone(after(41.0), false)), IsEmpty());
}

TEST(GoalMemory, LeavesItAloneForGoodAfterThree) {
  GoalMemory memory({.max_failures = 3});
  for (const double when : {0.0, 100.0, 200.0}) memory.add_failure(kTarget, {}, after(when));
  EXPECT_THAT(list(memory.left_alone(after(1e6), false)), ElementsAre(kForGood));
  EXPECT_FALSE(memory.forgive(after(201.0)));
  memory.clear();
  EXPECT_THAT(list(memory.left_alone(after(1e6), false)), IsEmpty());
}

// A frontier that was looked at is the building's; one that no path led to may be the robot's.
TEST(GoalMemory, SaysWhetherViewsOrPathsHaveFailed) {
  for (const bool has_failed_path : {false, true}) {
    GoalMemory memory({.max_failures = 2});
    memory.add_failure(kTarget, {Rejection::kFailedView}, after(0.0));
    memory.add_failure(kTarget, {has_failed_path ? Rejection::kFailed : Rejection::kFailedView}, after(100.0));
    const Rejection why = has_failed_path ? Rejection::kFailed : Rejection::kFailedView;
    EXPECT_THAT(list(memory.left_alone(after(1e6), false)), ElementsAre(std::pair(kTarget, why)));
  }
}

TEST(GoalMemory, ForgivesWhatHasNotFailedForGood) {
  GoalMemory memory({});
  memory.add_failure(kTarget, {}, after(0.0));
  EXPECT_TRUE(memory.forgive(after(1.0)));
  EXPECT_THAT(list(memory.left_alone(after(1.0), false)), IsEmpty());
  EXPECT_FALSE(memory.forgive(after(1.0))) << "nothing is left to forgive";
}

TEST(GoalMemory, WhatLiesNearIsOneTarget) {
  GoalMemory memory({.radius_m = 0.75, .max_failures = 2});
  memory.add_failure(kTarget, {}, after(0.0));
  memory.add_failure(kTarget + Eigen::Vector2d(0.5, 0.5), {}, after(0.0));
  EXPECT_THAT(list(memory.left_alone(after(1e6), false)), ElementsAre(kForGood));
  memory.add_failure(kTarget + Eigen::Vector2d(0.0, -0.8), {}, after(0.0));
  EXPECT_THAT(list(memory.left_alone(after(1e6), false)), ElementsAre(kForGood)) << "one failure elsewhere expires";
}

// Else it could fail as often again for each target beside it that has failed before.
TEST(GoalMemory, AFailureCountsForAllTargetsThatAreNear) {
  GoalMemory memory({.radius_m = 0.75, .max_failures = 3});
  for (const double x_m : {-0.7, 0.7, 0.0, -0.1, 0.1}) memory.add_failure({x_m, 0.0}, {}, after(0.0));
  EXPECT_THAT(list(memory.left_alone(after(1e6), false)),
              UnorderedElementsAre(given_up({-0.7, 0.0}), given_up({0.0, 0.0}), given_up({0.7, 0.0})));
}

TEST(GoalMemory, ForgetsWhereTheMapHasBecomeAnother) {
  GoalMemory memory({.max_failures = 1});
  memory.add_failure(kTarget, {}, after(0.0));
  memory.leave_alone({9.0, 9.0}, after(1e9));
  const auto known = [](int cells) { return [cells](const Eigen::Vector2d&) { return cells; }; };
  EXPECT_THAT(memory.forget_changed(known(20), 3), IsEmpty());
  EXPECT_THAT(memory.forget_changed(known(22), 3), IsEmpty());
  EXPECT_EQ(memory.left_alone(after(1.0), false).size(), 2U);
  EXPECT_THAT(memory.forget_changed(known(23), 3), ElementsAre(kTarget));
  EXPECT_EQ(memory.left_alone(after(29.0), false).size(), 2U) << "not at once";
  ASSERT_EQ(memory.left_alone(after(31.0), false).size(), 1U);
  EXPECT_EQ(memory.left_alone(after(31.0), false)[0].target_map.x(), 9.0) << "it has not failed";
}

TEST(GoalMemory, WhatFailedAdriftMaySucceedWhereSlamTracks) {
  GoalMemory memory({.max_failures = 1});
  memory.add_failure(kTarget, {.is_adrift = true}, after(0.0));
  EXPECT_THAT(list(memory.left_alone(after(1.0), true)), ElementsAre(kForGood));
  EXPECT_THAT(list(memory.left_alone(after(1.0), false)), IsEmpty());
  memory.add_failure({3.5, -2.0}, {.is_adrift = false}, after(2.0));
  EXPECT_THAT(list(memory.left_alone(after(3.0), true)), ::testing::Contains(kForGood)) << "then it fails in all tiers";
}

TEST(GoalMemory, TriesWhatWasGivenUpOnceMoreFromAnotherSide) {
  GoalMemory memory({.radius_m = 0.75, .max_failures = 2});
  const Eigen::Vector2d east = kTarget + Eigen::Vector2d(2.0, 0.0), north = kTarget + Eigen::Vector2d(0.0, 2.0);
  const auto why = [&](const Eigen::Vector2d& from_map) {
    return why_left_alone(memory.left_alone(after(1e3), false), kTarget, from_map, 0.75);
  };
  for (const double when : {0.0, 100.0}) memory.add_failure(kTarget, {.from_map = east}, after(when));
  EXPECT_EQ(why(north), Rejection::kFailed);
  EXPECT_TRUE(memory.forgive(after(1e3)));
  EXPECT_EQ(why(east), Rejection::kFailed);
  EXPECT_EQ(why(north), Rejection::kNone);
  EXPECT_FALSE(memory.forgive(after(1e3))) << "once";
  memory.add_failure(kTarget, {.from_map = north}, after(200.0));
  EXPECT_EQ(why(east), Rejection::kFailed);
  EXPECT_EQ(why(north), Rejection::kFailed);
  EXPECT_FALSE(memory.forgive(after(1e3)));
}

TEST(GoalMemory, WhoHasHadItsLastChanceWaitsWhileItIsJudged) {
  GoalMemory memory({.expiry_s = 30.0, .max_failures = 1});
  memory.add_failure(kTarget, {.from_map = Eigen::Vector2d(0.0, 0.0)}, after(0.0));
  EXPECT_TRUE(memory.forgive(after(100.0)));
  memory.leave_alone(kTarget, after(102.0));
  EXPECT_THAT(list(memory.left_alone(after(101.0), false)), ElementsAre(kForNow));
  EXPECT_FALSE(memory.left_alone(after(101.0), false)[0].side_map);
  EXPECT_TRUE(memory.left_alone(after(103.0), false)[0].side_map);
}

TEST(GoalMemory, LeavingAloneIsNoFailure) {
  GoalMemory memory({.expiry_s = 10.0, .max_failures = 1});
  memory.leave_alone(kTarget, after(2.0));
  EXPECT_THAT(list(memory.left_alone(after(1.0), false)), ElementsAre(kForNow));
  EXPECT_THAT(list(memory.left_alone(after(3.0), false)), IsEmpty());
}

}  // namespace
}  // namespace lapis::planner
