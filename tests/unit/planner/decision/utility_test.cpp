#include "planner/core/decision/utility.hpp"

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

const PathValue kValue{
    .cost_m = 4.0, .path_information = 20.0, .goal_information = 50.0, .loop_gain = 2.0, .d_optimality = 3.0};

TEST(Utility, IsWhatTheEquationsSay) {
  const UtilityConfig config{.beta = 0.5};
  EXPECT_DOUBLE_EQ(utility(Method::kPaper, kValue, config), 3.0 * (1.0 + 20.0 / 4.0));
  EXPECT_DOUBLE_EQ(utility(Method::kFixedN, kValue, config), 3.0 * (1.0 + 20.0 / 4.0));
  EXPECT_DOUBLE_EQ(utility(Method::kJoint, kValue, config), (20.0 + 0.5 * 3.0 * 2.0) / 4.0);
  EXPECT_DOUBLE_EQ(utility(Method::kSsmi, kValue, config), 50.0);
  EXPECT_DOUBLE_EQ(utility(Method::kNearest, kValue, config), 0.25);
  EXPECT_DOUBLE_EQ(utility(Method::kMiOnly, kValue, config), 5.0);
  EXPECT_DOUBLE_EQ(utility(Method::kDoptOnly, kValue, config), 3.0);
}

TEST(Utility, EdgeCases) {
  PathValue value = kValue;
  value.path_information = 0.0;
  EXPECT_DOUBLE_EQ(utility(Method::kPaper, value, {}), 3.0) << "alpha is infinite: the limit is D";
  value = kValue;
  value.cost_m = 0.0;
  EXPECT_DOUBLE_EQ(utility(Method::kMiOnly, value, {.least_cost_m = 0.25}), 80.0) << "a path of one voxel";
}

TEST(Methods, HaveNames) {
  for (const std::string& name : method_names()) EXPECT_TRUE(method_of(name)) << name;
  EXPECT_EQ(method_of("joint"), Method::kJoint);
  EXPECT_EQ(method_of("dopt_only"), Method::kDoptOnly);
  EXPECT_FALSE(method_of(""));
}

}  // namespace
}  // namespace lapis::planner
