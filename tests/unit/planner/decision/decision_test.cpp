#include "planner/core/decision/decision.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/planner/hallucination/small_world.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using test::camera_at;
using test::TextWorld;

// A corridor that ends in unknown space on both sides; the robot stands left of its middle. 8.5 m.
const std::vector<std::string> kCorridor = {
    "##################################",  //
    "..................................",  //
    "..................................",  //
    ".........R........................",  //
    "..................................",  //
    "..................................",  //
    "##################################",
};

struct Explorer {
  explicit Explorer(const std::vector<std::string>& lines = kCorridor)
      : world(lines), frontiers({}), field(0.25, mapping::SensorModel{}, Measure::kSemantic),
        view({.camera = test::kCamera, .columns = 16, .rows = 9, .range_m = 5.0}) {
    frontiers.update(world.grid, world.known);
    field.rebuild(world.map.map());
    config.method = Method::kMiOnly;
    config.viewpoints = {.min_distance_m = 0.5, .max_distance_m = 1.5, .max_per_frontier = 4};
    robot.p_map = world.grid.center_of(world.places.at('R'));
  }
  Decision choose(const Memory& memory = {}) const {
    return decide({world.grid, frontiers, field, view, geometry::T_base_camera({1.0, 0.0}), graph, landmarks, robot},
                  memory, config);
  }
  Candidate chosen(const Memory& memory = {}) const {
    const Decision decision = choose(memory);
    if (!decision.chosen) {
      ADD_FAILURE() << "nothing was chosen";
      return {};
    }
    return decision.candidates[*decision.chosen];
  }
  bool is_left(const Candidate& candidate) const { return candidate.goal.p_map.x() < robot.p_map.x(); }

  TextWorld world;
  FrontierMap frontiers;
  InformationField field;
  View view;
  DecisionConfig config;
  const AnalysedGraph* graph = nullptr;
  const LandmarkIndex* landmarks = nullptr;
  Pose2 robot;
};

TEST(Decide, EveryMethodDrivesToAFrontier) {
  Explorer explorer;
  for (const std::string& name : method_names()) {
    explorer.config.method = *method_of(name);
    const Candidate candidate = explorer.chosen();
    ASSERT_FALSE(candidate.way.empty()) << name;
    EXPECT_LT((candidate.way.front().p_map - explorer.robot.p_map).norm(), 1e-9) << name;
    EXPECT_LT((candidate.way.back().p_map - candidate.goal.p_map).norm(), 1e-9) << name;
    EXPECT_GT(candidate.value.path_information, 0.0) << name;
    for (const Pose2& pose : candidate.way) {
      EXPECT_TRUE(explorer.world.grid.is_traversable(explorer.world.grid.cell_of(pose.p_map))) << name;
    }
  }
  EXPECT_FALSE(method_of("tarot"));
}

TEST(Decide, TheNearestIsNearest) {
  Explorer explorer;
  explorer.config.method = Method::kNearest;
  EXPECT_TRUE(explorer.is_left(explorer.chosen()));
}

TEST(Decide, InformationPerMetreIsWhatMiOnlyCompares) {
  const Decision decision = Explorer().choose();
  ASSERT_TRUE(decision.chosen);
  EXPECT_TRUE(decision.agrees_with_mi_only());
  const Candidate& best = decision.candidates[*decision.chosen];
  for (const Candidate& candidate : decision.candidates) {
    EXPECT_DOUBLE_EQ(candidate.utility, candidate.value.path_information / candidate.value.cost_m);
    EXPECT_LE(candidate.utility, best.utility);
  }
}

TEST(Decide, LeavesAloneWhatItIsTold) {
  Explorer explorer;
  explorer.config.method = Method::kNearest;
  Memory memory;
  memory.left_alone = {explorer.chosen().target_map};
  const Decision decision = explorer.choose(memory);
  ASSERT_TRUE(decision.chosen);
  int left_alone = 0;
  for (const Candidate& candidate : decision.candidates) {
    const bool is_near = (candidate.target_map - memory.left_alone[0]).norm() <= memory.radius_m;
    EXPECT_EQ(candidate.rejection, is_near ? "left alone for now" : "");
    left_alone += is_near ? 1 : 0;
  }
  EXPECT_GT(left_alone, 0);
}

TEST(Decide, KeepsItsGoalUnlessAnotherIsClearlyBetter) {
  Explorer explorer;
  explorer.config.method = Method::kNearest;
  Memory memory;
  for (const Candidate& candidate : explorer.choose().candidates) {
    if (!explorer.is_left(candidate)) memory.goal = candidate.goal;
  }
  ASSERT_TRUE(memory.goal);
  explorer.config.keep_factor = 10.0;
  EXPECT_FALSE(explorer.is_left(explorer.chosen(memory)));
  explorer.config.keep_factor = 1.0;
  EXPECT_TRUE(explorer.is_left(explorer.chosen(memory)));
}

TEST(Decide, NamesEveryFrontierAndWhyItIsNotDrivenTo) {
  Explorer explorer({
      "######################",  //
      "#........########.....",  //
      "#........########.....",  //
      "#...R....########     ",  //
      "#........########     ",  //
      "#........########.....",  //
      "######...########.....",
  });
  const Decision decision = explorer.choose();
  std::set<std::uint32_t> named;
  int unreachable = 0;
  for (const Candidate& candidate : decision.candidates) {
    named.insert(candidate.frontier);
    unreachable += candidate.rejection == "cannot be reached" ? 1 : 0;
  }
  EXPECT_EQ(named.size(), explorer.frontiers.frontiers().size());
  EXPECT_GE(unreachable, 1) << "the room behind the wall";
  ASSERT_TRUE(decision.chosen);
  EXPECT_TRUE(decision.candidates[*decision.chosen].rejection.empty());
}

TEST(Decide, ComputesOnlyTheNearestButOneOfEachFrontierFirst) {
  Explorer explorer;
  explorer.config.max_candidates = 2;
  const Decision decision = explorer.choose();
  std::set<std::uint32_t> open;
  int too_far = 0;
  for (const Candidate& candidate : decision.candidates) {
    if (candidate.rejection.empty()) open.insert(candidate.frontier);
    too_far += candidate.rejection == "more than 2 others are nearer" ? 1 : 0;
  }
  EXPECT_EQ(open.size(), 2u);
  EXPECT_GT(too_far, 0);
}

TEST(Decide, NothingIsLeftInAClosedRoom) {
  const Decision decision = Explorer({"#######", "#.....#", "#..R..#", "#.....#", "#######"}).choose();
  EXPECT_TRUE(decision.candidates.empty());
  EXPECT_FALSE(decision.chosen);
  EXPECT_TRUE(decision.agrees_with_mi_only());
}

// slam came from the right end long ago; its first key-frames have seen a wall of landmarks there.
TEST(Decide, LoopsDrawTheJointUtilityToOldPlaces) {
  Explorer explorer;
  explorer.robot.yaw_rad = 3.14;
  const double y = explorer.robot.p_map.y(), x = explorer.robot.p_map.x();
  test::Chain chain(
      {camera_at(6.5, y, 0.0), camera_at(6.5, y - 15.0, 0.0), camera_at(x, y - 15.0, 0.0), camera_at(x, y, 0.0)});
  const AnalysedGraph graph = chain.graph();
  const LandmarkIndex landmarks(test::tile_of(test::wall_at(8.4f, static_cast<float>(y)), {10}), graph, 0.25);
  explorer.graph = &graph;
  explorer.landmarks = &landmarks;
  explorer.config.hallucination.covisibility.min_visibility = 0.0;
  explorer.config.sigma_limit_voxels = 0.01;
  explorer.config.method = Method::kJoint;
  explorer.config.utility.beta = 100.0;
  const Decision decision = explorer.choose();
  ASSERT_TRUE(decision.chosen);
  EXPECT_EQ(decision.problem, "");
  const Candidate& joint = decision.candidates[*decision.chosen];
  EXPECT_FALSE(explorer.is_left(joint));
  EXPECT_GE(joint.places, 1);
  EXPECT_LT(joint.gain.end_sigma_m, joint.gain.end_sigma_without_loops_m);
  explorer.config.utility.beta = 0.0;
  EXPECT_TRUE(explorer.is_left(explorer.chosen())) << "without loops the near end is worth more per metre";
}

TEST(Decide, IsDeterministic) {
  const Explorer explorer;
  const Decision a = explorer.choose(), b = explorer.choose();
  ASSERT_EQ(a.candidates.size(), b.candidates.size());
  for (std::size_t i = 0; i < a.candidates.size(); ++i) EXPECT_EQ(a.candidates[i].utility, b.candidates[i].utility);
}

}  // namespace
}  // namespace lapis::planner
