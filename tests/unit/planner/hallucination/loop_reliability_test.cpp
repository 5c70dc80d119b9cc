#include "planner/core/hallucination/loop_reliability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

using test::camera_at;

// Twice round a square of 6 m, a key-frame at each metre; the wall at (9, 0) was seen by the first ones. The second
// round closes a loop there, or does not.
FinishedRun two_rounds(std::size_t loop_from, std::size_t loop_to) {
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < 48; ++i) {
    const int side = i / 6 % 4, step = i % 6;
    const double x[] = {0.0 + step, 6.0, 6.0 - step, 0.0}, y[] = {0.0, 0.0 + step, 6.0, 6.0 - step};
    poses.push_back(camera_at(x[side], y[side], 1.5708 * side));
  }
  test::Chain chain(poses);
  chain.edges.push_back({10 + loop_from, 10 + loop_to, test::information(0.01, 0.01), true});
  return {chain.keyframes, chain.edges, test::tile_of(test::wall_at(6.9f), {14, 15, 38, 39}), test::free_field(),
          test::kCamera};
}

TEST(LoopOutcomes, TellWhetherAPredictedPlaceClosed) {
  for (const bool closes : {true, false}) {
    // Key-frame 28 is where 4 was; 40 and 16 are somewhere else.
    const FinishedRun run = closes ? two_rounds(28, 4) : two_rounds(40, 16);
    const auto result = loop_outcomes(run, {.covisibility = {}, .place_radius_m = 3.0}, 7.0, 1.0);
    ASSERT_TRUE(std::holds_alternative<LoopOutcomes>(result));
    const auto& outcomes = std::get<LoopOutcomes>(result);
    ASSERT_EQ(outcomes.places.size(), 1u) << "the wall, in the second round";
    EXPECT_EQ(outcomes.places[0].landmarks, 100);
    EXPECT_EQ(outcomes.places[0].has_closed, closes);
    EXPECT_EQ(outcomes.loops, 1);
    EXPECT_EQ(outcomes.unexpected, closes ? 0 : 1);
  }
}

TEST(LoopOutcomes, NameWhatIsWrongWithTheGraph) {
  FinishedRun run = two_rounds(28, 4);
  run.edges[3].information.setZero();
  EXPECT_TRUE(std::holds_alternative<GraphError>(loop_outcomes(run, {}, 5.0, 1.0)));
}

HallucinationConfig ramp(int impossible, int certain, double max_probability) {
  HallucinationConfig config;
  config.impossible_landmarks = impossible;
  config.certain_landmarks = certain;
  config.max_probability = max_probability;
  return config;
}

// Places that close with probability 0 at 40 landmarks and 0.8 at 200.
std::vector<LoopOutcome> drawn(int count) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<LoopOutcome> places;
  for (int i = 0; i < count; ++i) {
    const int landmarks = static_cast<int>(300.0 * share(engine));
    places.push_back({landmarks, share(engine) < 0.8 * std::min(1.0, (landmarks - 40) / 160.0)});
  }
  return places;
}

TEST(Reliability, CoversTheTruthWhenTheRampIsRight) {
  const auto places = drawn(4000);
  int count = 0;
  for (const ReliabilityBin& bin : reliability(places, ramp(40, 200, 0.8), 4)) {
    EXPECT_LE(bin.low, bin.mean_probability + 1e-12) << bin.from;
    EXPECT_GE(bin.high, bin.mean_probability - 1e-12) << bin.from;
    EXPECT_LT(bin.high - bin.low, 0.1);
    count += bin.places;
  }
  EXPECT_EQ(count, 4000);
  const auto wrong = reliability(places, ramp(40, 200, 1.0), 4);
  EXPECT_LT(wrong.back().high, wrong.back().mean_probability) << "too sure";
}

// 8 of 10: 0.490 to 0.943 in tables of the Wilson interval.
TEST(Reliability, IntervalIsWilsons) {
  std::vector<LoopOutcome> places(10, {1000, true});
  places[0].has_closed = places[1].has_closed = false;
  const ReliabilityBin bin = reliability(places, ramp(30, 120, 1.0), 4).back();
  EXPECT_NEAR(bin.low, 0.490, 5e-4);
  EXPECT_NEAR(bin.high, 0.943, 5e-4);
  EXPECT_TRUE(std::isnan(reliability(places, ramp(30, 120, 1.0), 4).front().mean_probability));
}

TEST(Reliability, TheMostLikelyRampIsTheRightOne) {
  const auto places = drawn(2000);
  const auto best = fit(places, {});
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->impossible_landmarks, 40, 8);
  EXPECT_NEAR(best->certain_landmarks, 200, 25);
  EXPECT_NEAR(best->max_probability, 0.8, 0.051);
  EXPECT_GE(log_likelihood(places, *best), log_likelihood(places, ramp(40, 200, 0.8)) - 1.0);
  EXPECT_FALSE(fit(std::vector<LoopOutcome>{{50, true}, {60, true}}, {})) << "nothing to distinguish them by";
}

}  // namespace
}  // namespace lapis::planner
