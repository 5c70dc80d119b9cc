#include "common/mapping/model/sensor_model.hpp"

#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::mapping {
namespace {

VoxelCounts counts(std::uint32_t misses, std::vector<std::pair<std::uint16_t, std::uint32_t>> hits) {
  VoxelCounts c{misses * kOneVote, {}};
  for (const auto& [label, n] : hits) c.hits.push_back({label, n * kOneVote});
  return c;
}

SensorModel model_of(int classes, double prior_occupied = 0.2) {
  SensorModel model;
  model.class_count = classes;
  model.prior_occupied = prior_occupied;
  return model;
}

double logit(double p) { return std::log(p / (1.0 - p)); }

/// Equation 11 taken literally: one addition per vote and class, no clamp.
std::vector<double> brute_force_log_odds(const SensorModel& m, const VoxelCounts& c) {
  const double pi = 1.0 / m.class_count;
  std::vector<double> y(static_cast<std::size_t>(m.class_count), logit(m.prior_occupied) + std::log(pi));
  for (std::uint32_t i = 0; i < c.misses / kOneVote; ++i)
    for (double& v : y) v -= m.miss_gain;
  for (const ClassCount& hit : c.hits)
    for (std::uint32_t i = 0; i < hit.count / kOneVote; ++i)
      for (std::size_t k = 0; k < y.size(); ++k) {
        if (hit.label == 0)
          y[k] += m.hit_gain;
        else if (hit.label == k + 1)
          y[k] += m.hit_gain + std::log(m.label_accuracy / pi);
        else
          y[k] += m.hit_gain + std::log((1 - m.label_accuracy) / (1 - pi));
      }
  return y;
}

TEST(BeliefReader, PaperPresetGivesTheReleasedSystemsEvolution) {
  // Repeated hits of one class that first takes 10 % of the occupied mass.
  const BeliefReader reader(paper_sensor_model({0.1, 0.9}));
  const double p_class[] = {0.13, 0.30, 0.55, 0.77, 0.91}, p_occupied[] = {0.52, 0.60, 0.73, 0.86, 0.94};
  for (std::uint32_t n = 1; n <= 5; ++n) {
    const VoxelCounts c = counts(0, {{1, n}});
    EXPECT_NEAR(reader.class_probabilities(c)[1], p_class[n - 1], 0.005) << n;
    EXPECT_NEAR(reader.occupied_probability(c), p_occupied[n - 1], 0.005) << n;
  }
}

TEST(BeliefReader, FortyClassesNeedNoMoreHitsThanTwo) {
  const BeliefReader reader(model_of(40));
  EXPECT_NEAR(reader.occupied_probability(counts(0, {{7, 1}})), 0.37, 0.005);
  EXPECT_NEAR(reader.occupied_probability(counts(0, {{7, 2}})), 0.96, 0.005);
  EXPECT_NEAR(reader.occupied_probability(counts(0, {{7, 3}})), 0.999, 0.0005);
}

TEST(BeliefReader, FirstHitMultipliesTheOddsByExpLForAnyNumberOfClasses) {
  for (const int classes : {1, 2, 4, 40, 1000}) {
    const BeliefReader reader(model_of(classes));
    const double prior = reader.occupancy_log_odds({});
    EXPECT_NEAR(prior, logit(0.2), 1e-12);
    EXPECT_NEAR(reader.occupancy_log_odds(counts(0, {{1, 1}})) - prior, 0.85, 1e-9) << classes;
    EXPECT_NEAR(reader.occupancy_log_odds(counts(1, {})) - prior, -0.4, 1e-12) << classes;
  }
}

TEST(BeliefReader, PaperIncrementsLetAFirstHitLowerTheProbabilityOfManyClasses) {
  const BeliefReader reader(paper_sensor_model(std::vector<double>(40, 1.0 / 40)));
  EXPECT_LT(reader.occupied_probability(counts(0, {{1, 1}})), 0.5);  // why it is not the default
}

TEST(BeliefReader, WallStaysOccupiedAfterThreeFramesLookThroughIt) {
  const BeliefReader reader(model_of(40));
  EXPECT_TRUE(reader.is_occupied(counts(0, {{1, 3}})));
  EXPECT_TRUE(reader.is_occupied(counts(3, {{1, 3}})));
}

TEST(BeliefReader, EqualsLiteralSumOverVotesOnRandomCounts) {
  std::mt19937 random(1);
  const auto number = [&random](int low, int high) {
    return static_cast<std::uint32_t>(std::uniform_int_distribution<int>(low, high)(random));
  };
  SensorModel model = model_of(12, 0.3);
  model.occupancy_limit = model.share_limit = 1e6;
  const BeliefReader reader(model);
  for (int trial = 0; trial < 200; ++trial) {
    VoxelCounts c = counts(number(0, 30), {{0, number(0, 2)}});
    for (std::uint16_t label = 1; label <= 12; ++label)
      if (number(0, 3) == 0) c.hits.push_back({label, number(1, 6) * kOneVote});
    const std::vector<double> y = brute_force_log_odds(model, c);
    double sum = 0.0;
    for (const double v : y) sum += std::exp(v);
    EXPECT_NEAR(reader.occupancy_log_odds(c), std::log(sum), 1e-9);
    const std::vector<double> p = reader.class_probabilities(c);
    EXPECT_NEAR(p[0], 1.0 / (1.0 + sum), 1e-9);
    for (std::size_t k = 0; k < y.size(); ++k) EXPECT_NEAR(p[k + 1], std::exp(y[k]) / (1.0 + sum), 1e-9);
    EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1.0, 1e-12);
  }
}

TEST(BeliefReader, LabelIsTheClassWithMostHitsAndTiesGoToTheSmallerId) {
  const BeliefReader reader(model_of(40));
  EXPECT_EQ(reader.label(counts(0, {{3, 2}, {5, 4}, {9, 4}})), 5);
  EXPECT_EQ(reader.label(counts(5, {{0, 9}, {4, 1}})), 4);
  EXPECT_EQ(reader.label(counts(5, {{0, 9}})), 0);
  EXPECT_EQ(reader.label({}), 0);
}

TEST(BeliefReader, LabelFollowsUnequalPriors) {
  const BeliefReader reader(paper_sensor_model({0.1, 0.9}));
  EXPECT_EQ(reader.label(counts(0, {{1, 1}})), 2);  // 0.1 e^1 < 0.9 e^-0.1
  EXPECT_EQ(reader.label(counts(0, {{1, 4}})), 1);
}

TEST(BeliefReader, UnlabelledAndUnlistedHitsRaiseOccupancyAndLeaveSharesAlone) {
  const BeliefReader reader(model_of(4));
  for (const std::uint16_t label : {std::uint16_t{0}, std::uint16_t{99}}) {
    const VoxelCounts c = counts(0, {{label, 1}});
    EXPECT_NEAR(reader.occupancy_log_odds(c) - logit(0.2), 0.85, 1e-12);
    const std::vector<double> p = reader.class_probabilities(c);
    for (std::size_t k = 2; k < p.size(); ++k) EXPECT_DOUBLE_EQ(p[k], p[1]);
    EXPECT_EQ(reader.label(c), 0);
  }
}

TEST(BeliefReader, OccupancyFloorDoesNotDependOnTheNumberOfClasses) {
  for (const int classes : {2, 40, 400}) {
    const BeliefReader reader(model_of(classes));
    EXPECT_NEAR(reader.occupied_probability(counts(100000, {})), 1e-4, 1e-8) << classes;
    EXPECT_NEAR(reader.occupied_probability(counts(0, {{1, 100000}})), 1 - 1e-4, 1e-8) << classes;
  }
}

class DirichletRules : public ::testing::TestWithParam<const char*> {
 protected:
  static SensorModel model(int classes) {
    SensorModel m = model_of(classes);
    m.fusion = GetParam();
    return m;
  }
};

INSTANTIATE_TEST_SUITE_P(Fusion, DirichletRules, ::testing::Values("dirichlet", "bki"));

TEST_P(DirichletRules, ProbabilitiesAreSharesOfTheConcentrations) {
  SensorModel m = model(3);
  m.prior_votes = 4.0;
  m.class_priors = {0.5, 0.3, 0.2};
  const BeliefReader reader(m);
  VoxelCounts c = counts(6, {{2, 5}});
  c.hits.push_back({3, kOneVote / 2});
  const double free = 4 * 0.8 + 6 * 0.4 / 0.85, prior = 4 * 0.2;
  const double of_class[] = {prior * 0.5, prior * 0.3 + 5, prior * 0.2 + 0.5};
  const double sum = free + prior + 5.5;
  const std::vector<double> p = reader.class_probabilities(c);
  EXPECT_NEAR(p[0], free / sum, 1e-12);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(p[k + 1], of_class[k] / sum, 1e-12) << k;
  EXPECT_EQ(reader.label(c), 2);
  EXPECT_EQ(reader.label(counts(0, {{3, 0}})), 1) << "the prior decides when nothing else does";
}

TEST_P(DirichletRules, UnlabelledVotesSpeakForOccupiedAndForNoClass) {
  const BeliefReader reader(model(2));
  const std::vector<double> p = reader.class_probabilities(counts(0, {{0, 3}, {1, 1}}));
  EXPECT_NEAR(p[0], 1.6 / 6.0, 1e-12);
  EXPECT_NEAR(p[1] / p[2], 1.2 / 0.2, 1e-9);
}

TEST_P(DirichletRules, TwoHitsMakeAVoxelOccupiedForAnyNumberOfClasses) {
  for (const int classes : {2, 4, 40}) {
    const BeliefReader reader(model(classes));
    EXPECT_NEAR(reader.occupied_probability({}), 0.2, 1e-12);
    EXPECT_FALSE(reader.is_occupied(counts(0, {{1, 1}})));
    EXPECT_TRUE(reader.is_occupied(counts(0, {{1, 2}})));
    EXPECT_TRUE(reader.is_occupied(counts(3, {{1, 3}})));
    EXPECT_LT(reader.occupied_probability(counts(1, {})), 0.2);
  }
}

TEST(BeliefReader, EntropyIsKnownAtItsExtremes) {
  const BeliefReader reader(model_of(4));
  const double p = 0.2;
  EXPECT_NEAR(reader.entropy({}), -(1 - p) * std::log(1 - p) - p * std::log(p / 4), 1e-12);
  EXPECT_LT(reader.entropy(counts(0, {{2, 50}})), 0.01);
  EXPECT_LT(reader.entropy(counts(50, {})), 0.01);
}

TEST(BeliefReader, RefusesParametersOutOfRange) {
  const auto with = [](auto change) {
    SensorModel model;
    change(model);
    return model;
  };
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.prior_occupied = 1.0; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.class_count = 0; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.prior_votes = 0.0; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.fusion = "average"; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.hit_gain = NAN; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.label_accuracy = 0.01; })), std::runtime_error);
  EXPECT_THROW(BeliefReader(with([](SensorModel& m) { m.class_priors = {0.5, 0.5}; })), std::runtime_error);
}

}  // namespace
}  // namespace lapis::mapping
