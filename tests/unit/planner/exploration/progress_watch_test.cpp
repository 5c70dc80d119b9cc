#include "planner/core/exploration/progress_watch.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

/// Drives to and fro between two places, a metre at a time, seeing nothing new; the distance until it is stalled [m].
double driven_until_stalled(ProgressWatch& watch, double apart_m) {
  double driven_m = 0.0;
  while (!watch.is_stalled() && driven_m < 1000.0) {
    driven_m += 1.0;
    const double x_m = std::abs(std::remainder(driven_m, 2.0 * apart_m));
    watch.note(0.4, {x_m, 0.0});
    if (x_m == 0.0 || x_m == apart_m) watch.set_out(apart_m);
  }
  return driven_m;
}

TEST(ProgressWatch, ToAndFroEndsAfterAFewTimes) {
  ProgressWatch watch(15.0);
  watch.note(0.4, {0.0, 0.0});
  watch.set_out(17.0);
  EXPECT_NEAR(driven_until_stalled(watch, 17.0), 15.0 + 2.0 * 17.0, 1.5);
  watch.begin_anew();
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, WhoSeesSomethingNewGetsOn) {
  ProgressWatch watch(5.0);
  for (int i = 0; i < 100; ++i) {
    watch.note(0.15 * i, {1.0 * i, 0.0});  // half a cubic metre every 3.3 m
    EXPECT_FALSE(watch.is_stalled()) << i;
  }
  for (int i = 100; i < 107; ++i) watch.note(15.0, {1.0 * i, 0.0});
  EXPECT_TRUE(watch.is_stalled());
  watch.note(16.0, {107.0, 0.0});
  EXPECT_FALSE(watch.is_stalled());
}

TEST(ProgressWatch, AFarPlaceMayBeDrivenToThroughWhatIsKnown) {
  ProgressWatch watch(15.0);
  watch.set_out(60.0);
  for (int i = 0; i <= 60; ++i) watch.note(0.0, {1.0 * i, 0.0});
  EXPECT_FALSE(watch.is_stalled());
}

}  // namespace
}  // namespace lapis::planner
