#include "slam/core/loops/loop_detector.hpp"

#include <gtest/gtest.h>

namespace lapis::slam {
namespace {

// A loop whose position along the corridor differs by `error_m` from what the graph says, which believes in `sigma_m`.
bool is_plausible_along(double error_m, double sigma_m) {
  geometry::Vector6d error = geometry::Vector6d::Zero();
  error.x() = error_m;
  const double variance = sigma_m * sigma_m;
  return is_plausible(error, variance * geometry::Matrix6d::Identity());
}

TEST(IsPlausible, AllowsErrorsUpToThreeTimesAsLargeAsBelieved) {
  EXPECT_TRUE(is_plausible_along(0.0, 0.05));
  EXPECT_TRUE(is_plausible_along(0.7, 0.05)) << "14 sigmas";
  EXPECT_FALSE(is_plausible_along(0.73, 0.05));
}

TEST(IsPlausible, IsStricterWhereRoomsCouldBeCopies) {
  EXPECT_FALSE(is_plausible_along(3.9, 0.5)) << "8 sigmas, a room further";
  EXPECT_TRUE(is_plausible_along(3.9, 0.9)) << "4 sigmas";
  for (double error_m = 0.1; error_m < 5.0; error_m += 0.01) {
    const double sigmas = error_m < 1.0 ? 14.0 : error_m > 3.0 ? 4.7 : 14.0 / error_m;
    EXPECT_TRUE(is_plausible_along(error_m, error_m / sigmas)) << error_m;
    EXPECT_FALSE(is_plausible_along(error_m, 0.95 * error_m / sigmas)) << error_m;
  }
}

}  // namespace
}  // namespace lapis::slam
