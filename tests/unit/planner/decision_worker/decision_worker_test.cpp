#include "planner/decision_worker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/camera_mount.hpp"
#include "planner/core/methods/methods.hpp"
#include "tests/unit/planner/hallucination/small_world.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using ::testing::HasSubstr;

/// A free square of 4 m, unknown all around, a robot in its middle, and three key-frames behind it.
class DecisionWorkerTest : public ::testing::Test {
 protected:
  DecisionWorkerTest() {
    test::FlatMap map(0.25);
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) map.set({x, y}, mapping::kFree);
    }
    const auto changed = map.flush();
    surroundings_.update_map(map.map(), changed);
  }
  DecisionInput input() const {
    DecisionInput input;
    input.surroundings = &surroundings_;
    input.view = &view_;
    input.T_base_camera = geometry::T_base_camera({1.0, 0.0});
    input.robot = {{2.0, 2.0}, 0.0};
    input.config.method = make_method("joint");
    return input;
  }
  static GraphMessage graph(int keyframes) {
    std::vector<geometry::Pose> poses;
    for (int i = 0; i < keyframes; ++i) poses.push_back(test::camera_at(1.0 + 0.3 * i, 2.0, 0.0));
    const test::Chain chain(poses);
    return {1, 1, chain.keyframes, chain.edges};
  }

  Surroundings surroundings_{{{}, {}, {}, {0.05, 0.2}}, mapping::SensorModel{}, 0.25};
  const View view_{{.camera = test::kCamera, .columns = 16, .rows = 9, .range_m = 5.0}};
  DecisionWorker worker_;
};

TEST_F(DecisionWorkerTest, ResultIsDueAtItsFrameAndNotBefore) {
  EXPECT_FALSE(worker_.is_busy());
  worker_.start(input(), 10);
  for (std::uint64_t frame = 7; frame < 10; ++frame) {
    EXPECT_FALSE(worker_.take(frame, true)) << frame;
    EXPECT_TRUE(worker_.is_busy());
  }
  const auto output = worker_.take(10, true);
  ASSERT_TRUE(output);
  EXPECT_TRUE(output->decision.chosen);
  EXPECT_GT(output->time_s, 0.0);
  EXPECT_FALSE(worker_.is_busy());
  EXPECT_FALSE(worker_.take(11, true)) << "a result is taken once";
}

TEST_F(DecisionWorkerTest, FrameThatWasMissedDoesNotLoseTheResult) {
  worker_.start(input(), 10);
  EXPECT_TRUE(worker_.take(13, true));
}

TEST_F(DecisionWorkerTest, LateResultIsWaitedForOnlyWhenAsked) {
  DecisionInput slow = input();
  slow.graph = graph(2000);
  worker_.start(std::move(slow), 1);
  EXPECT_FALSE(worker_.take(1, false)) << "done before it was asked for";
  EXPECT_TRUE(worker_.is_busy());
  EXPECT_TRUE(worker_.take(1, true));
}

TEST_F(DecisionWorkerTest, DiscardedResultNeverComes) {
  worker_.start(input(), 1);
  worker_.discard();
  EXPECT_FALSE(worker_.is_busy());
  EXPECT_FALSE(worker_.take(5, true));
  worker_.discard();  // of nothing
  worker_.start(input(), 6);
  EXPECT_TRUE(worker_.take(6, true));
}

TEST_F(DecisionWorkerTest, DecisionIsThatOfTheCore) {
  worker_.start(input(), 1);
  const Decision made = worker_.take(1, true)->decision;
  const DecisionInput in = input();
  const Decision expected = decide({surroundings_.grid(), surroundings_.frontiers(), surroundings_.field(), view_,
                                    in.T_base_camera, nullptr, nullptr, in.robot, surroundings_.compared_fields()},
                                   in.memory, in.config);
  EXPECT_EQ(made.chosen, expected.chosen);
  EXPECT_EQ(made.by_compared_fields, expected.by_compared_fields);
  EXPECT_EQ(made.by_compared_fields.size(), 2U);
  ASSERT_EQ(made.candidates.size(), expected.candidates.size());
  for (std::size_t i = 0; i < made.candidates.size(); ++i)
    EXPECT_EQ(made.candidates[i].utility, expected.candidates[i].utility);
}

TEST_F(DecisionWorkerTest, KnowledgeIsKeptUntilThereIsANewerGraph) {
  DecisionInput first = input();
  first.graph = graph(3);
  worker_.start(std::move(first), 1);
  const auto known = worker_.take(1, true)->knowledge;
  ASSERT_NE(known, nullptr);
  EXPECT_EQ(known->graph.keyframes.size(), 3U);

  DecisionInput second = input();
  second.knowledge = known;
  worker_.start(std::move(second), 2);
  auto output = worker_.take(2, true);
  EXPECT_EQ(output->knowledge, known) << "nothing new, nothing computed";
  EXPECT_GT(output->decision.candidates[*output->decision.chosen].value.optimality, 0.0) << "but used";

  DecisionInput third = input();
  third.knowledge = known;
  third.graph = graph(4);
  third.landmarks = test::tile_of(test::wall_at(3.0f, 2.0f), {10, 11});
  worker_.start(std::move(third), 3);
  output = worker_.take(3, true);
  ASSERT_NE(output->knowledge, nullptr);
  EXPECT_EQ(output->knowledge->graph.keyframes.size(), 4U);
  EXPECT_EQ(output->knowledge->landmarks.size(), 100U);
}

TEST_F(DecisionWorkerTest, GraphThatCannotBeUsedIsExplainedAndNoneIsUsedInstead) {
  DecisionInput first = input();
  first.graph = graph(3);
  worker_.start(std::move(first), 1);
  const auto known = worker_.take(1, true)->knowledge;

  DecisionInput second = input();
  second.knowledge = known;
  second.graph = graph(3);
  second.graph->edges.push_back({12, 99, test::information(0.01, 0.01)});
  worker_.start(std::move(second), 2);
  const auto output = worker_.take(2, true);
  EXPECT_EQ(output->knowledge, nullptr) << "the old graph is not the one of these poses";
  EXPECT_THAT(output->decision.problem, HasSubstr("key-frame that the pose graph does not have"));
  EXPECT_TRUE(output->decision.chosen) << "frontiers are driven to all the same";
}

}  // namespace
}  // namespace lapis::planner
