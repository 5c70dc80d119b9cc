#include "planner/core/hallucination/closed_loops.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

/// Five key-frames, 10 to 14, one metre apart.
test::Chain five_in_a_row() {
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(test::camera_at(i, 0.0, 0.0));
  return test::Chain(poses);
}

TEST(ClosedLoops, AreNamedByTheirKeyframes) {
  test::Chain chain = five_in_a_row();
  EXPECT_TRUE(names_of_loops(chain.graph()).empty());
  chain.edges.push_back({13, 10, test::information(0.02, 0.02), true});
  chain.edges.push_back({10, 12, test::information(0.02, 0.02), true});
  EXPECT_THAT(names_of_loops(chain.graph()), ::testing::ElementsAre(LoopName{10, 12}, LoopName{10, 13}));
}

TEST(ClosedLoops, GainIsTheDifferenceOfWholeFactors) {
  test::Chain chain = five_in_a_row();
  chain.edges.push_back({10, 12, test::information(0.02, 0.02), true});
  const AnalysedGraph before = chain.graph();
  chain.edges.push_back({10, 14, test::information(0.03, 0.02), true});
  chain.edges.push_back({12, 13, test::information(0.01, 0.02), true});  // beside odometry
  const AnalysedGraph after = chain.graph();
  const auto names = names_of_loops(before);
  EXPECT_EQ(gain_of_new_loops(before, names), 0.0);
  ASSERT_TRUE(gain_of_new_loops(after, names));
  EXPECT_NEAR(*gain_of_new_loops(after, names), after.factor.log_trees() - before.factor.log_trees(), 1e-9);
  EXPECT_GT(*gain_of_new_loops(after, {}), *gain_of_new_loops(after, names)) << "all loops are new";
}

TEST(ClosedLoops, WhatHangsByALoopAloneHasNoGain) {
  test::Chain chain = five_in_a_row();
  chain.edges.back().is_loop_closure = true;
  EXPECT_EQ(gain_of_new_loops(chain.graph(), {}), std::nullopt);
}

}  // namespace
}  // namespace lapis::planner
