#include "planner/core/exploration/path_ledger.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

time::Time second(double seconds) { return time::Time::from_seconds(seconds); }

Pose2 at(double x_m, double y_m, double yaw_rad = 0.0) { return {{x_m, y_m}, yaw_rad}; }

/// From 2 rad aside the robot turns to the x axis, which promises a fifth, and drives four metres of a fifth each.
Decision decision(double goal_x_m, double cost_m, double nats) {
  Decision made;
  Candidate& chosen = made.candidates.emplace_back();
  chosen.goal = at(goal_x_m, 0.0);
  chosen.value.cost_m = cost_m;
  made.promised.push_back({at(0.0, 0.0, 2.0), 0.0});
  for (int i = 0; i < 5; ++i) made.promised.push_back({at(i, 0.0), nats * (i + 1) / 5});
  made.chosen = 0;
  return made;
}

TEST(PathLedger, SettlesAPathWhenAnotherGoalIsChosen) {
  PathLedger ledger(0.75);
  const Decision first = decision(1.0, 5.0, 40.0), later = decision(1.3, 2.0, 10.0), last = decision(1.7, 1.0, 4.0),
                 other = decision(1.8, 7.0, 70.0);
  EXPECT_EQ(ledger.note(&first, {100.0}, at(0.0, 0.0), second(1.0)), std::nullopt);
  EXPECT_EQ(ledger.note(&later, {120.0}, at(1.0, 0.0), second(2.0)), std::nullopt);
  EXPECT_EQ(ledger.note(&last, {130.0}, at(2.0, 0.0), second(3.0)), std::nullopt) << "it has crept forward";
  const DrivenPath expected{second(1.0), second(4.0), CandidateKind::kFrontier, 5.0, 40.0, 28.0, 35.0};
  EXPECT_EQ(ledger.note(&other, {135.0}, at(2.5, 0.1), second(4.0)), expected) << "half of the third metre";
}

TEST(PathLedger, WhatWasTurnedCountsByHeading) {
  for (const auto& [yaw_rad, nats] : {std::pair{2.0, 0.0}, {1.5, 2.0}, {0.5, 6.0}, {0.0, 8.0}}) {
    PathLedger ledger(0.75);
    const Decision made = decision(1.0, 5.0, 40.0);
    ledger.note(&made, {0.0}, at(0.0, 0.0, 2.0), second(1.0));
    EXPECT_DOUBLE_EQ(ledger.note(nullptr, {3.0}, at(0.0, 0.0, yaw_rad), second(2.0))->driven_nats, nats);
  }
}

TEST(PathLedger, SettlesAPathWhenNothingIsChosen) {
  PathLedger ledger(0.75);
  EXPECT_EQ(ledger.note(nullptr, {50.0}, at(0.0, 0.0), second(0.0)), std::nullopt);
  const Decision only = decision(1.0, 5.0, 40.0);
  EXPECT_EQ(ledger.note(&only, {60.0}, at(0.0, 0.0), second(1.0)), std::nullopt);
  const auto ended = ledger.note(nullptr, {61.0}, at(4.0, 0.0), second(2.0));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->gained_nats, 1.0);
  EXPECT_EQ(ended->driven_nats, 40.0);
  EXPECT_EQ(ledger.note(nullptr, {62.0}, at(4.0, 0.0), second(3.0)), std::nullopt) << "it is settled once";
}

TEST(PathLedger, ComparesWhatLoopsWereExpectedToBringWithWhatTheyBrought) {
  test::Chain chain({test::camera_at(0, 0, 0), test::camera_at(1, 0, 0), test::camera_at(2, 0, 0)});
  chain.edges.push_back({10, 12, test::information(0.02, 0.02), true});
  const AnalysedGraph before = chain.graph();
  chain.edges.push_back({10, 12, test::information(0.01, 0.02), true});
  chain.keyframes.push_back({13, test::camera_at(2.5, 0, 0)});
  chain.edges.push_back({12, 13, test::information(0.01, 0.01)});
  chain.edges.push_back({10, 13, test::information(0.02, 0.02), true});
  const AnalysedGraph after = chain.graph();
  Decision made = decision(1.0, 5.0, 40.0);
  made.candidates[0].gain.loop_gain = 1.5;
  for (const bool is_asked : {false, true}) {
    PathLedger ledger(0.75);
    made.known.spectrum = is_asked;
    ledger.note(&made, {0.0, &before}, at(0.0, 0.0), second(1.0));
    const auto ended = ledger.note(nullptr, {0.0, &after}, at(1.0, 0.0), second(2.0));
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->promised_loop_gain, is_asked ? std::optional(1.5) : std::nullopt);
    EXPECT_EQ(ended->loop_gain, is_asked ? gain_of_new_loops(after, names_of_loops(before)) : std::nullopt);
    EXPECT_TRUE(!is_asked || ended->loop_gain > 0.0);
  }
}

}  // namespace
}  // namespace lapis::planner
