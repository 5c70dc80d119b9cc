#include "planner/core/methods/methods.hpp"

#include <gtest/gtest.h>

#include "planner/core/methods/consolidation.hpp"

namespace lapis::planner {
namespace {

constexpr PathValue kValue{.cost_m = 4.0,
                           .path_information = 20.0,
                           .goal_information = 50.0,
                           .loop_gain = 2.0,
                           .optimality = 3.0,
                           .fixed_n_d_optimality = 5.0,
                           .unknown_share = 0.25};

double utility(const Method& method, const PathValue& value) {
  Candidate candidate;
  candidate.value = value;
  return method.utility(candidate);
}
double utility(const char* method, const PathValue& value) {
  return utility(*make_method(method, {.joint = {.beta = 0.5}}), value);
}

TEST(Methods, UtilityIsWhatTheEquationsSay) {
  EXPECT_DOUBLE_EQ(utility("paper", kValue), 3.0 * (1.0 + 20.0 / 4.0));
  EXPECT_DOUBLE_EQ(utility("fixed_n", kValue), 5.0 * (1.0 + 20.0 / 4.0));
  EXPECT_DOUBLE_EQ(utility("joint", kValue), (20.0 + 0.5 * 3.0 * 2.0) / 4.0);
  EXPECT_DOUBLE_EQ(utility("ssmi", kValue), 50.0);
  EXPECT_DOUBLE_EQ(utility("nearest", kValue), 0.25);
  EXPECT_DOUBLE_EQ(utility("mi_only", kValue), 5.0);
  EXPECT_DOUBLE_EQ(utility("dopt_only", kValue), 3.0);
  EXPECT_DOUBLE_EQ(utility("placed", kValue), 3.0 * 1.25);
}

TEST(Methods, EdgeCases) {
  PathValue value = kValue;
  value.path_information = 0.0;
  EXPECT_DOUBLE_EQ(utility("paper", value), 3.0) << "alpha is infinite: the limit is D";
  value = kValue;
  value.cost_m = 0.0;
  EXPECT_DOUBLE_EQ(utility("mi_only", value), 80.0) << "a path of one voxel";
}

// Who is judged by what was not computed would compare zeros.
TEST(Methods, AskForAllThatTheirUtilityIsMadeOf) {
  for (const std::string& name : method_names()) {
    const auto method = make_method(name);
    ASSERT_TRUE(method) << name;
    PathValue asked{.cost_m = 4.0, .tour_place = 2};
    if (method->asks().path_information) asked.path_information = kValue.path_information;
    if (method->asks().goal_information) asked.goal_information = kValue.goal_information;
    if (method->asks().unknown_share) asked.unknown_share = kValue.unknown_share;
    if (method->asks().spectrum) {
      asked.loop_gain = kValue.loop_gain;
      asked.optimality = kValue.optimality;
      asked.fixed_n_d_optimality = kValue.fixed_n_d_optimality;
    }
    PathValue all = kValue;
    all.tour_place = 2;
    EXPECT_EQ(utility(*method, asked), utility(*method, all)) << name;
    EXPECT_GT(utility(*method, asked), 0.0) << name;
  }
}

TEST(Methods, ThoseOfThePaperHaveNoHysteresisAndOnlyTareHasATourOfItsOwn) {
  for (const std::string& name : method_names()) {
    EXPECT_EQ(make_method(name)->keeps_goal(), name != "paper" && name != "placed") << name;
    EXPECT_EQ(make_method(name)->has_own_candidates(), name == "tare") << name;
  }
}

// And old places as goals.
TEST(Methods, LoopsAreWorthSomethingToThoseWithAGraphInTheirUtility) {
  for (const std::string& name : method_names()) {
    const bool has_graph =
        name == "paper" || name == "fixed_n" || name == "joint" || name == "dopt_only" || name == "placed";
    EXPECT_EQ(make_method(name)->asks().spectrum, has_graph) << name;
  }
}

TEST(Methods, LapisIsOneOfThem) {
  EXPECT_EQ(utility(*make_method("lapis"), kValue), utility(*make_method("joint"), kValue));
  EXPECT_EQ(make_method(""), nullptr);
}

Candidate place_at(double x_m, double cost_m) {
  Candidate candidate;
  candidate.target_map = {x_m, 1.0};
  candidate.value.cost_m = cost_m;
  candidate.value.path_information = 3.0;
  return candidate;
}

TEST(Methods, OldPlacesAreChosenByCostByChanceOrByLapis) {
  for (const std::string& name : consolidation_names()) ASSERT_TRUE(make_consolidation(name)) << name;
  EXPECT_FALSE(make_consolidation("none"));
  EXPECT_FALSE(make_consolidation("mi_only"));
  const auto nearest = make_consolidation("nearest"), random = make_consolidation("random");
  EXPECT_GT(nearest->utility(place_at(1.0, 2.0)), nearest->utility(place_at(1.0, 3.0)));
  EXPECT_EQ(random->utility(place_at(1.0, 2.0)), random->utility(place_at(1.0, 3.0)));
  EXPECT_NE(random->utility(place_at(1.0, 2.0)), random->utility(place_at(2.0, 2.0)));
  const Candidate any = place_at(1.0, 2.0);
  EXPECT_EQ(make_consolidation("lapis")->utility(any), make_method("lapis")->utility(any));
  EXPECT_EQ(make_consolidation("lapis")->asks(), make_method("lapis")->asks());
}

}  // namespace
}  // namespace lapis::planner
