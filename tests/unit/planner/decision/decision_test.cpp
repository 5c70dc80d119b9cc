#include "planner/core/decision/decision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "planner/core/candidates/gap_views.hpp"
#include "planner/core/decision/first_turn.hpp"
#include "planner/core/methods/expected.hpp"
#include "planner/core/methods/methods.hpp"
#include "planner/core/uncertainty/map_worth.hpp"
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
      : world(lines), frontiers({}), field(0.25, mapping::SensorModel{}, {Measure::kSemantic}),
        view({.camera = test::kCamera, .columns = 16, .rows = 9, .range_m = 5.0}) {
    frontiers.update(world.grid, world.known);
    field.rebuild(world.map.map());
    config.method = make_method("mi_only");
    config.viewpoints = {.min_distance_m = 0.5, .max_distance_m = 1.5, .max_per_frontier = 4};
    robot.p_map = world.grid.center_of(world.places.at('R'));
  }
  Decision choose(const Memory& memory = {}) const {
    return decide({world.grid, frontiers, field, view, geometry::T_base_camera({1.0, 0.0}), graph, landmarks, robot,
                   compared_fields},
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
  std::vector<InformationField> compared_fields;
  View view;
  DecisionConfig config;
  const AnalysedGraph* graph = nullptr;
  const LandmarkIndex* landmarks = nullptr;
  Pose2 robot;
};

TEST(Decide, EveryMethodDrivesToAFrontier) {
  Explorer explorer;
  for (const std::string& name : method_names()) {
    explorer.config.method = make_method(name);
    const Candidate candidate = explorer.chosen();
    ASSERT_FALSE(candidate.path.empty()) << name;
    EXPECT_LT((candidate.path.front().p_map - explorer.robot.p_map).norm(), 1e-9) << name;
    EXPECT_LT((candidate.path.back().p_map - candidate.goal.p_map).norm(), 1e-9) << name;
    EXPECT_GT(candidate.utility, 0.0) << name;
    for (const Pose2& pose : candidate.path) {
      EXPECT_TRUE(explorer.world.grid.is_traversable(explorer.world.grid.cell_of(pose.p_map))) << name;
    }
  }
  EXPECT_EQ(make_method("tarot"), nullptr);
}

TEST(Decide, TheNearestIsNearest) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  EXPECT_TRUE(explorer.is_left(explorer.chosen()));
}

TEST(Decide, InformationPerMetreIsWhatMiOnlyCompares) {
  const Decision decision = Explorer().choose();
  ASSERT_TRUE(decision.chosen);
  const Candidate& best = decision.candidates[*decision.chosen];
  for (const Candidate& candidate : decision.candidates) {
    EXPECT_DOUBLE_EQ(candidate.utility, candidate.value.path_information / candidate.value.cost_m);
    EXPECT_LE(candidate.utility, best.utility);
  }
}

TEST(Decide, LeavesAloneWhatItIsAskedTo) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  Memory memory;
  memory.left_alone = {{explorer.chosen().target_map}};
  const Decision decision = explorer.choose(memory);
  ASSERT_TRUE(decision.chosen);
  int left_alone = 0;
  for (const Candidate& candidate : decision.candidates) {
    const bool is_near = (candidate.target_map - memory.left_alone[0].target_map).norm() <= memory.radius_m;
    EXPECT_EQ(candidate.rejection, is_near ? Rejection::kLeftAlone : Rejection::kNone);
    left_alone += is_near ? 1 : 0;
  }
  EXPECT_GT(left_alone, 0);
}

TEST(Decide, SaysWhatIsLeftWhenNothingIsChosen) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  EXPECT_TRUE(explorer.choose({}).leftover.length_m.empty());
  Memory memory;
  memory.left_alone = {{explorer.chosen().target_map}};
  memory.radius_m = 1000.0;
  const Decision decision = explorer.choose(memory);
  ASSERT_FALSE(decision.chosen);
  double left_m = 0.0, to_blame_m = 0.0;
  for (const auto& [reason, length_m] : decision.leftover.length_m) {
    left_m += length_m;
    to_blame_m += is_geometric(reason) ? 0.0 : length_m;
  }
  double all_m = 0.0;
  for (const auto& entry : explorer.frontiers.frontiers()) all_m += entry.second.length_m;
  EXPECT_NEAR(left_m, all_m, 1e-9);
  EXPECT_GT(to_blame_m, 0.0);
  EXPECT_NEAR(decision.leftover.share_to_blame, to_blame_m / all_m, 1e-12);
}

// Through what is narrower than itself the robot cannot have missed a room.
TEST(Decide, NobodyIsToBlameForNarrowFrontiers) {
  for (const bool is_wide : {false, true}) {
    Explorer explorer({"##################", "#................#", "#................#", "#........R.......#",
                       "#................#", "#................#",
                       is_wide ? "####...###########" : "####.#############"});
    explorer.config.gaps.least_nats = 0.0;
    Memory memory;
    memory.left_alone = {{explorer.robot.p_map}};
    memory.radius_m = 1000.0;
    const Decision decision = explorer.choose(memory);
    ASSERT_FALSE(decision.chosen);
    ASSERT_FALSE(decision.leftover.length_m.empty());
    EXPECT_EQ(decision.leftover.share_to_blame > 0.0, is_wide);
  }
}

TEST(Decide, ByOdometryAloneItStaysWithinTheBudget) {
  for (const std::string& name : method_names()) {
    Explorer explorer;
    explorer.config.method = make_method(name);
    Memory memory;
    memory.adrift = {.sigma_m = 0.1, .growth = 0.1, .budget_m = 0.5};
    int near = 0, far = 0;
    for (const Candidate& candidate : explorer.choose(memory).candidates) {
      const bool is_sure = 0.1 + 0.1 * candidate.value.cost_m <= 0.5;
      EXPECT_EQ(candidate.rejection == Rejection::kUnsure, !is_sure) << name;
      ++(is_sure ? near : far);
    }
    EXPECT_GT(near, 0) << name;
    EXPECT_TRUE(far > 0 || name == "tare") << name << ": whose tour has one stop here";
  }
}

TEST(Decide, BeyondTheBudgetItDrivesToWhereSlamTracked) {
  for (const std::string& name : method_names()) {
    Explorer explorer;
    explorer.config.method = make_method(name);
    const Pose2 behind{explorer.robot.p_map - Eigen::Vector2d(0.5, 0.0), 1.0};
    Memory memory;
    for (const double sigma_m : {0.6, std::numeric_limits<double>::quiet_NaN()}) {
      memory.adrift = {.sigma_m = sigma_m, .growth = 0.1, .budget_m = 0.5, .tracked = {{{1e3, 0.0}, 0.0}, behind}};
      const Decision decision = explorer.choose(memory);
      ASSERT_TRUE(decision.chosen) << name;
      const Candidate& back = decision.candidates[*decision.chosen];
      EXPECT_EQ(back.kind, CandidateKind::kTracked) << name;
      EXPECT_LT((back.goal.p_map - behind.p_map).norm(), explorer.world.grid.resolution_m()) << name;
      EXPECT_EQ(back.goal.yaw_rad, 1.0) << name;
    }
    memory.adrift->tracked.clear();
    const Decision nothing = explorer.choose(memory);
    EXPECT_FALSE(nothing.chosen) << name;
    EXPECT_GT(nothing.leftover.share_to_blame, 0.0) << name;
  }
}

// Above and below the layer that is known, nothing is; no frontier says so.
TEST(Decide, LooksAtGapsOfTheMapWhenNoFrontierIsLeft) {
  const std::vector<std::string> hall = {"##################", "#................#", "#................#",
                                         "#........R.......#", "#................#", "#................#",
                                         "##################"};
  for (const std::string& name : method_names()) {
    Explorer explorer(hall);
    explorer.config.method = make_method(name);
    explorer.config.gaps = {.least_nats = 5.0};
    Memory memory;
    EXPECT_FALSE(explorer.choose(memory).chosen) << name << ": not before the mission says so";
    memory.looks_at_gaps = true;
    int taken = 0;
    for (;; ++taken) {
      const Decision decision = explorer.choose(memory);
      if (!decision.chosen) break;
      const Candidate& gap = decision.candidates[*decision.chosen];
      ASSERT_EQ(gap.kind, CandidateKind::kGap) << name;
      ASSERT_FALSE(is_taken(gap.goal, memory.taken_views)) << name;
      EXPECT_GE(path_information(explorer.field, explorer.view,
                                 {camera_at({explorer.world.grid,
                                             explorer.frontiers,
                                             explorer.field,
                                             explorer.view,
                                             geometry::T_base_camera({1.0, 0.0}),
                                             nullptr,
                                             nullptr,
                                             {}},
                                            gap.goal)}),
                5.0);
      memory.taken_views.push_back(gap.goal);
      ASSERT_LT(taken, 1000) << name;
    }
    EXPECT_GT(taken, 8) << name;
    memory.taken_views.clear();
    memory.gap_places = {{explorer.robot.p_map}};
    memory.radius_m = 1000.0;
    EXPECT_FALSE(explorer.choose(memory).chosen) << name << ": places that have failed";
    memory.gap_places.clear();
    explorer.config.gaps.least_nats = 0.0;
    EXPECT_FALSE(explorer.choose(memory).chosen) << name << ": unless told not to";
  }
}

TEST(Decide, LooksAtFrontiersBeforeGaps) {
  Explorer explorer;
  explorer.config.gaps = {.least_nats = 1.0};
  Memory memory;
  memory.looks_at_gaps = true;
  for (const Candidate& candidate : explorer.choose(memory).candidates) EXPECT_NE(candidate.kind, CandidateKind::kGap);
}

TEST(Decide, LooksFromElsewhereAtWhatAFailedViewShowed) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  const Candidate first = explorer.chosen();
  Memory memory;
  memory.failed_views = {{first.target_map, first.goal.p_map}};
  int rejected = 0;
  for (const Candidate& candidate : explorer.choose(memory).candidates) {
    const bool is_the_same = (candidate.target_map - first.target_map).norm() <= memory.radius_m &&
                             (candidate.goal.p_map - first.goal.p_map).norm() <= memory.radius_m;
    EXPECT_EQ(candidate.rejection, is_the_same ? Rejection::kFailedView : Rejection::kNone);
    rejected += is_the_same ? 1 : 0;
  }
  EXPECT_GT(rejected, 0);
  const Candidate& next = explorer.chosen(memory);
  EXPECT_GT((next.goal.p_map - first.goal.p_map).norm(), memory.radius_m);
}

TEST(Decide, KeepsItsGoalUnlessAnotherIsClearlyBetter) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  Memory memory;
  for (const Candidate& candidate : explorer.choose().candidates) {
    if (!explorer.is_left(candidate)) memory.goal = candidate.goal;
  }
  ASSERT_TRUE(memory.goal);
  explorer.config.keep_factor = 10.0;
  EXPECT_FALSE(explorer.is_left(explorer.chosen(memory)));
  explorer.config.method = make_method("paper");
  EXPECT_EQ(explorer.choose(memory).chosen, explorer.choose().chosen) << "the paper keeps nothing";
  explorer.config.method = make_method("nearest");
  explorer.config.max_candidates = 1;
  EXPECT_FALSE(explorer.is_left(explorer.chosen(memory))) << "however many are nearer";
  explorer.config.max_candidates = 20;
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
    unreachable += candidate.rejection == Rejection::kUnreachable ? 1 : 0;
  }
  EXPECT_EQ(named.size(), explorer.frontiers.frontiers().size());
  EXPECT_GE(unreachable, 1) << "the room behind the wall";
  ASSERT_TRUE(decision.chosen);
  EXPECT_TRUE(decision.candidates[*decision.chosen].is_open());
}

TEST(Decide, ComputesOnlyTheNearestButOneOfEachFrontierFirst) {
  Explorer explorer;
  explorer.config.max_candidates = 2;
  const Decision decision = explorer.choose();
  std::set<std::uint32_t> open;
  int too_far = 0;
  for (const Candidate& candidate : decision.candidates) {
    if (candidate.is_open()) open.insert(candidate.frontier);
    too_far += candidate.rejection == Rejection::kOutranked ? 1 : 0;
  }
  EXPECT_EQ(open.size(), 2u);
  EXPECT_GT(too_far, 0);
}

TEST(Decide, NothingIsLeftInAClosedRoom) {
  Explorer explorer({"#######", "#.....#", "#..R..#", "#.....#", "#######"});
  explorer.config.compared_methods = {make_method("nearest")};
  const Decision decision = explorer.choose();
  EXPECT_TRUE(decision.candidates.empty());
  EXPECT_FALSE(decision.chosen || decision.by_compared_methods.at(0));
}

TEST(Decide, SaysWhatOtherMethodsWouldHaveChosenAndComputesNothingElse) {
  Explorer explorer;
  explorer.config.method = make_method("nearest");
  const Decision alone = explorer.choose();
  EXPECT_EQ(alone.known, Asks{});
  EXPECT_EQ(alone.candidates[*alone.chosen].value.path_information, 0.0);
  explorer.config.compared_methods = {make_method("mi_only"), make_method("nearest")};
  const Decision compared = explorer.choose();
  EXPECT_EQ(compared.known, Asks{.path_information = true});
  EXPECT_EQ(compared.chosen, alone.chosen);
  explorer.config.method = make_method("mi_only");
  EXPECT_EQ(compared.by_compared_methods, (std::vector{explorer.choose().chosen, alone.chosen}));
  EXPECT_NE(compared.by_compared_methods[0], compared.by_compared_methods[1]);
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
  explorer.config.method = make_method("joint", {.joint = {.beta = 100.0}});
  const Decision decision = explorer.choose();
  ASSERT_TRUE(decision.chosen);
  EXPECT_EQ(decision.problem, "");
  const Candidate& joint = decision.candidates[*decision.chosen];
  EXPECT_FALSE(explorer.is_left(joint));
  ASSERT_FALSE(joint.loops.empty());
  EXPECT_GT(joint.loops[0].probability, 0.0);
  EXPECT_LE(joint.loops[0].probability, 1.0);
  EXPECT_GT((joint.loops[0].node_map - joint.loops[0].keyframe_map).norm(), 0.0);
  EXPECT_FALSE(joint.nodes_map.empty());
  EXPECT_LT(joint.gain.end_sigma_m, joint.gain.end_sigma_without_loops_m);
  explorer.config.method = make_method("joint", {.joint = {.beta = 0.0}});
  EXPECT_TRUE(explorer.is_left(explorer.chosen())) << "without loops the near end is worth more per metre";
}

// Landmarks all around but for what is behind on the right.
TEST(Decide, TurnsTheWayRoundThatKeepsLandmarksInView) {
  Explorer explorer;
  const double x = explorer.robot.p_map.x(), y = explorer.robot.p_map.y();
  std::vector<geometry::Pose> cameras;
  for (int i = 0; i < 8; ++i) cameras.push_back(camera_at(x, y, 0.5 * i));
  test::Chain chain(cameras);
  const AnalysedGraph graph = chain.graph();
  std::vector<Eigen::Vector3f> points;
  for (double angle_rad = 0.0; angle_rad <= 3.5; angle_rad += 0.02) {
    for (const double z : {0.8, 1.0, 1.2})
      points.emplace_back(
          Eigen::Vector3d(x + 1.5 * std::cos(angle_rad), y + 1.5 * std::sin(angle_rad), z).cast<float>());
  }
  const LandmarkIndex landmarks(test::tile_of(points, {10, 11, 12, 13, 14, 15, 16, 17}), graph, 0.25);
  explorer.graph = &graph;
  explorer.landmarks = &landmarks;
  explorer.config.hallucination.covisibility.min_visibility = 0.0;
  const auto turn = [&](double heading_rad, int side = 0) {
    const Situation situation{
        explorer.world.grid, explorer.frontiers, explorer.field, explorer.view, geometry::T_base_camera({1.0, 0.0}),
        explorer.graph,      explorer.landmarks, explorer.robot};
    return first_turn(situation, heading_rad, side, explorer.config.hallucination.covisibility);
  };
  EXPECT_TRUE(turn(1.0).empty()) << "a short turn";
  EXPECT_TRUE(turn(3.0).empty()) << "the shorter way is good";
  const std::vector<double> longer = turn(-2.8);
  ASSERT_FALSE(longer.empty());
  EXPECT_GT(longer.front(), 0.0);
  EXPECT_NEAR(longer.back(), 2.0 * std::numbers::pi - 2.8, 1e-9);
  explorer.robot.yaw_rad = -0.3;
  const Decision decision = explorer.choose();
  ASSERT_TRUE(decision.chosen && explorer.is_left(decision.candidates[*decision.chosen]));
  ASSERT_FALSE(decision.first_turn_rad.empty());
  EXPECT_GT(decision.first_turn_rad.front(), -0.3) << "to the left, though the right is shorter";
  EXPECT_EQ(decision.promised[0].robot.yaw_rad, -0.3) << "what is in view counts";
  EXPECT_EQ(decision.promised[1].robot.yaw_rad, decision.first_turn_rad.front());
  explorer.robot.yaw_rad = 0.0;
  const LandmarkIndex none({}, graph, 0.25);
  explorer.landmarks = &none;
  EXPECT_TRUE(turn(-2.8).empty()) << "either way leads past blank views";
  ASSERT_FALSE(turn(-2.8, 1).empty()) << "it has begun to turn to the left";
  EXPECT_NEAR(turn(-2.8, 1).back(), 2.0 * std::numbers::pi - 2.8, 1e-9);
  ASSERT_FALSE(turn(-2.8, -1).empty()) << "it has begun to turn to the right, which is shorter by now";
  EXPECT_NEAR(turn(-2.8, -1).back(), -2.8, 1e-9);
  EXPECT_TRUE(turn(-1.0, 1).empty()) << "a short turn is left";
  explorer.robot.yaw_rad = 0.4;
  Memory memory;
  memory.goal = Pose2{{-5.0, 0.0}, 0.0};
  memory.turns_to = -1;
  const std::vector<double> resumed = explorer.choose(memory).first_turn_rad;
  ASSERT_FALSE(resumed.empty());
  EXPECT_LT(resumed.front(), 0.4) << "whatever the goal was";
}

// Before slam has two key-frames, and when its graph cannot be judged.
TEST(Decide, WithoutAGraphThePaperComparesInformationPerMetre) {
  Explorer explorer;
  test::Chain broken({camera_at(0.5, 0.5, 0.0), camera_at(1.5, 0.5, 0.0)});
  AnalysedGraph graph = broken.graph();
  const LandmarkIndex landmarks({}, graph, 0.25);
  graph.odometry_weight_metres = std::numeric_limits<double>::quiet_NaN();
  explorer.config.compared_methods = {make_method("mi_only")};
  for (const char* method : {"paper", "fixed_n"}) {
    explorer.config.method = make_method(method);
    for (const bool has_graph : {false, true}) {
      explorer.graph = has_graph ? &graph : nullptr;
      explorer.landmarks = has_graph ? &landmarks : nullptr;
      const Decision decision = explorer.choose();
      EXPECT_EQ(decision.problem.empty(), !has_graph);
      EXPECT_TRUE(decision.chosen && decision.chosen == decision.by_compared_methods[0]);
      for (const Candidate& candidate : decision.candidates) {
        if (!candidate.is_open()) continue;
        EXPECT_DOUBLE_EQ(candidate.utility, 1.0 + candidate.value.path_information / candidate.value.cost_m);
        EXPECT_TRUE(candidate.loops.empty());
      }
    }
  }
}

// A corridor round a block; the robot stands west of it, what is unknown lies east. 8 by 4 m.
const std::vector<std::string> kBlock = {
    "#################################",  //
    "#...............................#",  //
    "#...............................#",  //
    "#...............................#",  //
    "#........###############........#",  //
    "#........###############........ ",  //
    "#....R...###############........ ",  //
    "#........###############........ ",  //
    "#........###############........#",  //
    "#...............................#",  //
    "#...............................#",  //
    "#...............................#",  //
    "#################################",
};

int count(const Decision& decision, CandidateKind kind) {
  return static_cast<int>(std::count_if(decision.candidates.begin(), decision.candidates.end(),
                                        [&](const Candidate& c) { return c.kind == kind; }));
}

TEST(Decide, AlternativesGoRoundTheOtherSide) {
  Explorer explorer(kBlock);
  EXPECT_EQ(count(explorer.choose(), CandidateKind::kAlternative), 0) << "unless asked for";
  explorer.config.alternatives = 1;
  const Decision decision = explorer.choose();
  ASSERT_EQ(count(decision, CandidateKind::kAlternative), static_cast<int>(explorer.frontiers.frontiers().size()));
  const Candidate& other = decision.candidates.back();
  const auto best = std::find_if(decision.candidates.begin(), decision.candidates.end(), [&](const Candidate& c) {
    return c.kind == CandidateKind::kFrontier && (c.goal.p_map - other.goal.p_map).norm() < 1e-9;
  });
  ASSERT_NE(best, decision.candidates.end());
  const auto is_above = [&](const Candidate& c) {
    return std::any_of(c.path.begin(), c.path.end(), [](const Pose2& pose) { return pose.p_map.y() > 2.0; });
  };
  EXPECT_NE(is_above(other), is_above(*best));
  EXPECT_LE(other.value.cost_m, 1.6 * best->value.cost_m);
  EXPECT_GT(other.value.path_information, 0.0);
  EXPECT_EQ(other.frontier, best->frontier);
}

// slam came from the middle of the corridor, where it saw much, and has gone a long way since.
struct LongAway : Explorer {
  explicit LongAway(const std::vector<std::string>& lines = kCorridor, double y = 0.9, double yaw = 1.57)
      : Explorer(lines), chain({camera_at(4.5, y, yaw), camera_at(4.6, y, yaw), camera_at(4.5, -20.0, 0.0),
                                camera_at(2.4, -20.0, 0.0), camera_at(2.4, 0.9, 0.0)}),
        of_graph(chain.graph()), of_landmarks(test::tile_of(test::wall_at(4.5f, 3.0f), {10, 11}), of_graph, 0.25) {
    graph = &of_graph;
    landmarks = &of_landmarks;
    config.method = make_method("joint");
  }
  test::Chain chain;
  AnalysedGraph of_graph;
  LandmarkIndex of_landmarks;
};

// Of the three utilities, one counts nodes as the paper does, one compares graphs of equal size; both with the gain
// that the candidate says.
TEST(Decide, EachMethodComparesItsOwnFormOfD) {
  LongAway explorer;
  const int nodes = explorer.of_graph.factor.node_count();
  const double log_trees = explorer.of_graph.factor.log_trees();
  for (const bool is_paper : {true, false}) {
    explorer.config.method = make_method(is_paper ? "paper" : "fixed_n");
    const Decision decision = explorer.choose();
    ASSERT_EQ(decision.problem, "");
    for (const Candidate& candidate : decision.candidates) {
      if (!candidate.is_open()) continue;
      const double fixed_n = d_optimality(nodes, log_trees + candidate.gain.fixed_n_change);
      EXPECT_NEAR(candidate.value.fixed_n_d_optimality / fixed_n, 1.0, 1e-12);
      EXPECT_GT(std::abs(candidate.value.optimality / fixed_n - 1.0), 1e-12);
      const double d = is_paper ? candidate.value.optimality : candidate.value.fixed_n_d_optimality;
      EXPECT_DOUBLE_EQ(candidate.utility, d * (1.0 + candidate.value.path_information / candidate.value.cost_m));
    }
  }
}

TEST(Decide, RevisitsAnOldPlaceWhenItIsUnsure) {
  LongAway explorer;
  const double sigma_m = position_sigma_m(explorer.of_graph);
  EXPECT_EQ(count(explorer.choose(), CandidateKind::kRevisit), 0) << "unless asked for";
  explorer.config.revisit_sigma_m = 1.1 * sigma_m;
  EXPECT_EQ(count(explorer.choose(), CandidateKind::kRevisit), 0) << "it is sure enough";
  explorer.config.revisit_sigma_m = 0.9 * sigma_m;
  const Decision decision = explorer.choose();
  ASSERT_EQ(count(decision, CandidateKind::kRevisit), 1) << "two key-frames at one place";
  const Candidate& revisit = decision.candidates.back();
  EXPECT_EQ(revisit.frontier, 0u);
  EXPECT_LT((revisit.goal.p_map - Eigen::Vector2d(4.5, 0.9)).norm(), 0.3);
  EXPECT_NEAR(revisit.goal.yaw_rad, 1.57, 1e-6) << "the key-frame's own heading";
  EXPECT_GT(revisit.value.cost_m, 2.0);
  Memory memory;
  memory.old_places = {{revisit.target_map}};
  EXPECT_EQ(explorer.choose(memory).candidates.back().rejection, Rejection::kLeftAlone);
  memory.old_places.clear();
  memory.adrift = {.sigma_m = 0.6, .growth = 0.1, .budget_m = 0.5};
  EXPECT_EQ(count(explorer.choose(memory), CandidateKind::kRevisit), 0) << "it drives to where slam tracked";
  explorer.config.method = make_method("nearest");
  EXPECT_EQ(count(explorer.choose(), CandidateKind::kRevisit), 0) << "loops are worth nothing to it";
}

// What the map at stake is worth: most of it hangs on the key-frames after the long way round.
struct AtStake : LongAway {
  explicit AtStake(double sigma_factor = 1.0)
      : LongAway(kCorridor, 0.9, 0.0), in_corridor(test::tile_of(test::wall_at(6.5f, 0.9f), {10, 11}), of_graph, 0.25) {
    landmarks = &in_corridor;
    SurfaceStakes stakes;
    for (std::uint64_t id = 10; id < 15; ++id) stakes.voxels[id] = {0.0, 20.0, 100.0, 200.0};
    MapWorthConfig worth_config;
    worth_config.sigma_factor = sigma_factor;
    of_map.emplace(std::get<MapWorth>(MapWorth::make(chain.keyframes, chain.edges, stakes, worth_config)));
    config.method = std::make_shared<Expected>();
  }
  Decision choose_by_worth() const {
    return decide({world.grid,
                   frontiers,
                   field,
                   view,
                   geometry::T_base_camera({1.0, 0.0}),
                   graph,
                   landmarks,
                   robot,
                   {},
                   &*of_map},
                  {}, config);
  }
  LandmarkIndex in_corridor;
  std::optional<MapWorth> of_map;
};

TEST(Decide, RevisitsWhatSecuresMostOfTheMap) {
  const AtStake explorer;
  const Decision decision = explorer.choose_by_worth();
  ASSERT_EQ(count(decision, CandidateKind::kRevisit), 1) << "two key-frames at one place";
  const Candidate& revisit = decision.candidates.back();
  EXPECT_LT((revisit.target_map - Eigen::Vector2d(4.5, 0.9)).norm(), 0.3);
  EXPECT_GT(revisit.value.secured_nats, 10.0);
  EXPECT_LT(revisit.value.secured_nats, explorer.of_map->lost_nats());
  for (const Candidate& candidate : decision.candidates) {
    if (!candidate.is_open()) continue;
    EXPECT_LT(candidate.value.surviving_share, 1.0);
    EXPECT_DOUBLE_EQ(candidate.utility, (candidate.value.path_information * candidate.value.surviving_share +
                                         candidate.value.secured_nats) /
                                            candidate.value.paid_m());
  }
}

TEST(Decide, WithExactPosesTheMapsWorthChangesNothing) {
  AtStake explorer(0.0);
  const Decision by_worth = explorer.choose_by_worth();
  explorer.config.method = make_method("mi_only");
  const Decision by_information = explorer.choose();
  ASSERT_EQ(by_worth.candidates.size(), by_information.candidates.size());
  EXPECT_EQ(by_worth.chosen, by_information.chosen);
  EXPECT_EQ(by_worth.candidates[*by_worth.chosen].utility, by_information.candidates[*by_information.chosen].utility);
}

TEST(Decide, AnAlternativePassesAnOldPlaceInItsDirection) {
  std::vector<std::string> hall(20, "#.................................");
  hall.front() = hall.back() = "##################################";
  hall[8][6] = 'R';
  LongAway explorer(hall, 1.1, 0.3);
  explorer.config.alternatives = 1;
  const Decision decision = explorer.choose();
  ASSERT_GE(count(decision, CandidateKind::kAlternative), 1);
  const Candidate& past = decision.candidates.back();
  const auto near = std::find_if(past.points.begin(), past.points.end(),
                                 [](const Eigen::Vector2d& p) { return (p - Eigen::Vector2d(4.5, 1.1)).norm() < 0.3; });
  ASSERT_LT(near - past.points.begin(), std::ssize(past.points) - 1);
  const Eigen::Vector2d on = *(near + 1) - *near;
  EXPECT_NEAR(std::atan2(on.y(), on.x()), 0.3, 0.2) << "as the key-frame looked, but for the cells";
  explorer.config.path.max_detour = 1.0;
  EXPECT_EQ(count(explorer.choose(), CandidateKind::kAlternative), 0) << "too long a path round";
}

TEST(Decide, InformationFromAnUnsurePositionCountsLess) {
  LongAway explorer;
  explorer.config.compared_methods = {make_method("ssmi")};
  const Decision sure = explorer.choose();
  explorer.config.information_discount_sigma_m = position_sigma_m(explorer.of_graph);
  const Decision unsure = explorer.choose();
  ASSERT_EQ(sure.candidates.size(), unsure.candidates.size());
  for (std::size_t i = 0; i < sure.candidates.size(); ++i) {
    const Candidate &all = sure.candidates[i], &less = unsure.candidates[i];
    if (!all.is_open()) continue;
    const double share = less.value.path_information / all.value.path_information;
    EXPECT_LE(share, 0.55) << "half at the robot's sigma";
    EXPECT_GE(share, 0.2);
    ASSERT_GT(all.value.goal_information, 0.0);
    const double end = all.gain.end_sigma_m / explorer.config.information_discount_sigma_m;
    EXPECT_NEAR(less.value.goal_information, all.value.goal_information / (1.0 + end * end), 1e-9);
  }
}

TEST(Decide, ADiscountAsksForTheSpectrumWhereThereIsInformationToDiscount) {
  LongAway explorer;
  explorer.config.method = make_method("mi_only");
  const double all = explorer.chosen().value.path_information;
  explorer.config.information_discount_sigma_m = position_sigma_m(explorer.of_graph);
  EXPECT_EQ(explorer.choose().known, (Asks{.path_information = true, .spectrum = true}));
  EXPECT_LT(explorer.chosen().value.path_information, all);
  explorer.config.method = make_method("nearest");
  EXPECT_EQ(explorer.choose().known, Asks{});
}

InformationField field_with_prior(const Explorer& explorer, double prior_occupied) {
  mapping::SensorModel model;
  model.prior_occupied = prior_occupied;
  InformationField field(0.25, model, {Measure::kSemantic});
  field.rebuild(explorer.world.map.map());
  return field;
}

TEST(Decide, ReportsWhatOtherFieldsWouldHaveChosenAndChoosesTheSame) {
  const std::vector<double> priors = {0.02, 0.1, 0.5, 0.8};
  int others = 0;
  for (const std::string& name : method_names()) {
    LongAway explorer;
    explorer.config.method = make_method(name);
    Memory memory;
    for (const bool has_goal : {false, true}) {
      const Decision alone = explorer.choose(memory);
      for (const double prior : priors) explorer.compared_fields.push_back(field_with_prior(explorer, prior));
      const Decision made = explorer.choose(memory);
      explorer.compared_fields.clear();
      EXPECT_EQ(made.chosen, alone.chosen) << name;
      for (std::size_t i = 0; i < made.candidates.size(); ++i)
        EXPECT_EQ(made.candidates[i].utility, alone.candidates[i].utility) << name;
      ASSERT_EQ(made.by_compared_fields.size(), priors.size());
      EXPECT_TRUE(alone.by_compared_fields.empty());
      for (std::size_t k = 0; k < priors.size(); ++k) {
        const InformationField own = std::exchange(explorer.field, field_with_prior(explorer, priors[k]));
        EXPECT_EQ(made.by_compared_fields[k], explorer.choose(memory).chosen) << name << ", prior " << priors[k];
        explorer.field = own;
        others += made.by_compared_fields[k] == made.chosen ? 0 : 1;
      }
      ASSERT_TRUE(alone.chosen);
      if (!has_goal) memory.goal = alone.candidates[(*alone.chosen + 1) % alone.candidates.size()].goal;
    }
  }
  EXPECT_GT(others, 0) << "of no use as a test";
}

TEST(Decide, IsDeterministic) {
  const Explorer explorer;
  const Decision a = explorer.choose(), b = explorer.choose();
  ASSERT_EQ(a.candidates.size(), b.candidates.size());
  for (std::size_t i = 0; i < a.candidates.size(); ++i) EXPECT_EQ(a.candidates[i].utility, b.candidates[i].utility);
}

}  // namespace
}  // namespace lapis::planner
