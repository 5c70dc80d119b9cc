#include "planner/core/exploration/progress_watch.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

constexpr Allowance kFor15m{.metres = 15.0, .seconds = 1000.0};

time::Time noted_at(double seconds) { return time::Time::from_seconds(seconds); }

/// Drives to and fro between two places, a metre a second, seeing nothing new; the distance until it is stalled [m].
double driven_until_stalled(ProgressWatch& watch, double apart_m) {
  double driven_m = 0.0;
  while (!watch.is_stalled() && driven_m < 1000.0) {
    driven_m += 1.0;
    const double x_m = std::abs(std::remainder(driven_m, 2.0 * apart_m));
    watch.note(0.4, {x_m, 0.0}, noted_at(driven_m));
    if (x_m == 0.0 || x_m == apart_m) watch.set_out(apart_m);
  }
  return driven_m;
}

TEST(ProgressWatch, ToAndFroEndsAfterAFewTimes) {
  ProgressWatch watch(kFor15m);
  watch.note(0.4, {0.0, 0.0}, noted_at(0.0));
  watch.set_out(17.0);
  EXPECT_NEAR(driven_until_stalled(watch, 17.0), 15.0 + 2.0 * 17.0, 1.5);
  watch.begin_anew();
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, WhoTurnsOnTheSpotStallsAfterATime) {
  ProgressWatch watch({.metres = 15.0, .seconds = 60.0});
  watch.set_out(1.0);
  int seconds = 0;
  for (; !watch.is_stalled() && seconds < 1000; ++seconds) watch.note(0.0, {1.0, 2.0}, noted_at(seconds));
  EXPECT_NEAR(seconds, 60 + 2 * 4, 2);
}

TEST(ProgressWatch, WhoSeesSomethingNewGetsOn) {
  ProgressWatch watch({.metres = 5.0, .seconds = 1000.0});
  for (int i = 0; i < 100; ++i) {
    watch.note(0.15 * i, {1.0 * i, 0.0}, noted_at(i));  // half a cubic metre every 3.3 m
    EXPECT_FALSE(watch.is_stalled()) << i;
  }
  for (int i = 100; i < 107; ++i) watch.note(15.0, {1.0 * i, 0.0}, noted_at(i));
  EXPECT_TRUE(watch.is_stalled());
  watch.note(16.0, {107.0, 0.0}, noted_at(107));
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, InALargeMapProgressIsAShareOfIt) {
  ProgressWatch watch({.metres = 5.0, .seconds = 1000.0});
  watch.note(2000.0, {0.0, 0.0}, noted_at(0));
  for (int i = 1; i < 10; ++i) watch.note(2000.0 + 0.15 * i, {1.0 * i, 0.0}, noted_at(i));
  EXPECT_TRUE(watch.is_stalled());
  watch.note(2002.5, {10.0, 0.0}, noted_at(10));
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, AfterACorrectionGrowthCountsFromWhatIsLeft) {
  ProgressWatch watch({.metres = 5.0, .seconds = 1000.0});
  watch.note(30.0, {0.0, 0.0}, noted_at(0));
  for (int i = 1; i < 20; ++i) {
    watch.note(20.0 + 0.3 * i, {1.0 * i, 0.0}, noted_at(i));
    EXPECT_FALSE(watch.is_stalled()) << i;
  }
}

TEST(ProgressWatch, JitterOfTheMapIsNoProgress) {
  ProgressWatch watch({.metres = 5.0, .seconds = 1000.0});
  for (int i = 0; i < 7; ++i) watch.note(i % 2 == 0 ? 30.0 : 29.6, {1.0 * i, 0.0}, noted_at(i));
  EXPECT_TRUE(watch.is_stalled());
}

TEST(ProgressWatch, AFarPlaceMayBeDrivenToThroughWhatIsKnown) {
  ProgressWatch watch(kFor15m);
  watch.set_out(60.0);
  for (int i = 0; i <= 60; ++i) watch.note(0.0, {1.0 * i, 0.0}, noted_at(i));
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, WhatOthersDroveMeanwhileDoesNotCount) {
  ProgressWatch watch({.metres = 5.0, .seconds = 10.0});
  watch.note(0.0, {0.0, 0.0}, noted_at(0));
  watch.note(0.0, {100.0, 0.0}, noted_at(100));
  EXPECT_FALSE(watch.is_stalled());
}

}  // namespace
}  // namespace lapis::planner
