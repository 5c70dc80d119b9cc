#include "planner/core/hallucination/hallucination.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

using test::camera_at;
using test::Chain;
using test::free_field;
using test::kCamera;
using test::tile_of;
using test::wall_at;

constexpr double kNoLimit_m = 1e-6;

// A drive along x, up, back, and half down again; key-frame 10 has seen a wall 3 m in front of it.
struct Square {
  Square() : chain(poses()) {}
  static std::vector<geometry::Pose> poses() {
    return {camera_at(0, 0, 0), camera_at(2, 0, 0), camera_at(4, 0, 1.57), camera_at(4, 4, 3.1),
            camera_at(0, 4, -1.57)};
  }
  Hallucination drive(const std::vector<geometry::Pose>& path) const {
    const AnalysedGraph graph = chain.graph();
    const LandmarkIndex index(tile_of(wall_at(3.0f), {10}), graph, 0.25);
    return hallucinate(graph, index, free_field(), kCamera, path, config);
  }

  Chain chain;
  HallucinationConfig config;
};

const std::vector<geometry::Pose> kHome{camera_at(0, 2, -1.57), camera_at(0, 0.2, 0)};

// By new factors of whole graphs: of the new nodes and certain edges, with and without the loops of a set.
double log_trees(const AnalysedGraph& graph, const std::vector<KeyframeEdge>& edges, const Hallucination& path,
                 PlaceSet places) {
  std::vector<WeightedEdge> all;
  for (const KeyframeEdge& edge : edges)
    all.push_back({*graph.node_of(edge.from), *graph.node_of(edge.to), *edge_weight(edge.information, Criterion::kD)});
  for (const HallucinatedEdge& edge : path.graph.edges) {
    if (edge.place == HallucinatedEdge::kCertain || (places & only_place(edge.place)) != 0) all.push_back(edge.edge);
  }
  const auto whole = WeightedGraph::make(graph.factor.node_count() + path.graph.node_count, all);
  return std::get<LaplacianFactor>(LaplacianFactor::make(std::get<WeightedGraph>(whole))).log_trees();
}

TEST(Hallucinate, OdometryFallsWithDistance) {
  const Square world;
  const Hallucination path = world.drive({camera_at(0, 3, -1.57), camera_at(0, 1, -1.57)});
  ASSERT_EQ(path.graph.node_count, 2);
  ASSERT_EQ(path.graph.edges.size(), 2u);
  EXPECT_EQ(path.graph.edges[0].edge.a, 4) << "the newest key-frame";
  EXPECT_EQ(path.graph.edges[0].edge.b, 5);
  EXPECT_NEAR(path.graph.edges[0].edge.weight, 2.0 * path.graph.edges[1].edge.weight, 1e-6);
}

TEST(Hallucinate, FindsTheOldPlaceFromTheNodeThatSeesMostOfIt) {
  Square world;
  world.config.impossible_landmarks = 30;
  world.config.certain_landmarks = 120;
  world.config.max_probability = 0.75;
  const Hallucination path = world.drive(kHome);
  ASSERT_EQ(path.places.size(), 1u);
  EXPECT_EQ(path.places[0].keyframe, 0);
  EXPECT_EQ(path.places[0].node, 1);
  EXPECT_EQ(path.places[0].landmarks, 100);
  EXPECT_NEAR(path.places[0].probability, 0.75 * 70.0 / 90.0, 1e-12);
  const HallucinatedEdge& loop = path.graph.edges.back();
  EXPECT_EQ(loop.place, 0);
  EXPECT_EQ(loop.edge.a, 6);
  EXPECT_EQ(loop.edge.b, 0);
}

TEST(Hallucinate, NearKeyframesAndFewLandmarksMakeNoLoop) {
  Square world;
  world.config.min_loop_path_m = 40.0;
  EXPECT_TRUE(world.drive(kHome).places.empty());
  world = Square();
  world.config.impossible_landmarks = 100;
  EXPECT_TRUE(world.drive(kHome).places.empty());
}

TEST(Hallucinate, APlaceThatWasJustClosedToCountsLater) {
  Square world;
  world.chain.edges.push_back({10, 14, test::information(0.01, 0.01), true});
  world.config.min_loop_path_m = 1.0;
  EXPECT_TRUE(world.drive(kHome).places.empty());
  world.config.revisit_spacing_m = 3.0;
  EXPECT_EQ(world.drive(kHome).places.size(), 1u);
}

TEST(ExpectGain, EqualsTheMeanOverAllOutcomesOfWholeFactors) {
  const Square world;
  const AnalysedGraph graph = world.chain.graph();
  const Hallucination path = world.drive(kHome);
  const auto expected = std::get<ExpectedGain>(expect_gain(graph, path, kNoLimit_m));
  const double gain =
      log_trees(graph, world.chain.edges, path, kEveryPlace) - log_trees(graph, world.chain.edges, path, kNoPlace);
  EXPECT_NEAR(expected.saturated_loop_gain, path.places[0].probability * gain, 1e-9);
  EXPECT_GT(expected.fixed_n_change, 0.0);
  EXPECT_LT(expected.end_sigma_m, expected.end_sigma_without_loops_m);
  // A chain: the variances of its edges add.
  double variance = 0.0;
  for (const auto& edge : path.graph.edges)
    variance += edge.place == HallucinatedEdge::kCertain ? 1.0 / edge.edge.weight : 0.0;
  variance += 4.0 * 1e-4;
  EXPECT_NEAR(expected.end_sigma_without_loops_m, std::sqrt(variance), 1e-9);
}

TEST(ExpectGain, OfTwoPlacesCountsAllFourOutcomes) {
  const Square world;
  const AnalysedGraph graph = world.chain.graph();
  Hallucination path = world.drive({camera_at(0, 3, -1.57), camera_at(0, 1, -1.57)});
  path.places = {{.keyframe = 0, .node = 1, .probability = 0.3}, {.keyframe = 1, .node = 0, .probability = 0.6}};
  path.graph.edges.push_back({{6, 0, 2e4}, 0});
  path.graph.edges.push_back({{5, 1, 1e4}, 1});
  const auto expected = std::get<ExpectedGain>(expect_gain(graph, path, kNoLimit_m));
  const auto of_outcome = std::get<CandidateGain>(CandidateGain::make(graph.factor, path.graph));
  const double none = log_trees(graph, world.chain.edges, path, kNoPlace);
  double loop_gain = 0.0, fixed_n = 0.0, sigma_m = 0.0;
  for (const auto& [places, probability] : std::initializer_list<std::pair<PlaceSet, double>>{
           {kNoPlace, 0.7 * 0.4}, {only_place(0), 0.3 * 0.4}, {only_place(1), 0.7 * 0.6}, {kEveryPlace, 0.3 * 0.6}}) {
    loop_gain += probability * (log_trees(graph, world.chain.edges, path, places) - none);
    fixed_n += probability * of_outcome.fixed_n_change(places);
    sigma_m += probability * std::sqrt(of_outcome.variance(6, places) * graph.position_variance_per_resistance);
  }
  EXPECT_NEAR(expected.saturated_loop_gain, loop_gain, 1e-9);
  EXPECT_NEAR(expected.fixed_n_change, fixed_n, 1e-12);
  EXPECT_NEAR(expected.end_sigma_m, sigma_m, 1e-12);
}

TEST(ExpectGain, LoopsBeyondTheLimitAreWorthNothing) {
  const Square world;
  const AnalysedGraph graph = world.chain.graph();
  const Hallucination path = world.drive(kHome);
  const auto gain_at = [&](double limit_m) {
    return std::get<ExpectedGain>(expect_gain(graph, path, limit_m)).saturated_loop_gain;
  };
  const double all = gain_at(kNoLimit_m);
  const auto expected = std::get<ExpectedGain>(expect_gain(graph, path, kNoLimit_m));
  EXPECT_DOUBLE_EQ(expected.loop_gain, all);
  EXPECT_DOUBLE_EQ(std::get<ExpectedGain>(expect_gain(graph, path, expected.end_sigma_without_loops_m)).loop_gain, all);
  EXPECT_EQ(gain_at(expected.end_sigma_without_loops_m), 0.0) << "the end is sure enough without";
  // Of the logarithm of the variance, the part above the limit counts.
  const double probability = path.places[0].probability;
  const double without_m = expected.end_sigma_without_loops_m;
  const double with_m = (expected.end_sigma_m - (1.0 - probability) * without_m) / probability;
  ASSERT_LT(with_m, 0.9 * without_m);
  EXPECT_NEAR(gain_at(0.9 * without_m), all * std::log(1.0 / 0.9) / std::log(without_m / with_m), 1e-9);
  EXPECT_NEAR(gain_at(0.5 * with_m), all, 1e-12);
}

TEST(Hallucinate, ALoopWeighsWhatItIsToldTo) {
  Square world;
  const double by_graph = world.drive(kHome).graph.edges.back().edge.weight;
  EXPECT_EQ(by_graph, world.chain.graph().loop_weight);
  world.config.loop_weight = 10.0;
  EXPECT_DOUBLE_EQ(world.drive(kHome).graph.edges.back().edge.weight,
                   10.0 * world.chain.graph().odometry_weight_metres);
}

TEST(LiteralOptimality, WeighsLoopsByTheirProbability) {
  const Square world;
  const AnalysedGraph graph = world.chain.graph();
  Hallucination path = world.drive(kHome);
  const double literal = std::get<double>(literal_optimality(graph, path));
  path.graph.edges.back().edge.weight *= path.places[0].probability;
  const int nodes = graph.factor.node_count() + path.graph.node_count;
  EXPECT_NEAR(literal, d_optimality(nodes, log_trees(graph, world.chain.edges, path, kEveryPlace)), 1e-9 * literal);
}

TEST(LiteralOptimality, OfEveryCriterionIsThatOfAllTheEigenvalues) {
  const Square world;
  const Hallucination path = world.drive(kHome);
  for (const Criterion criterion : {Criterion::kD, Criterion::kA, Criterion::kT, Criterion::kE}) {
    GraphConfig config;
    config.criterion = criterion;
    const auto graph = std::get<AnalysedGraph>(analyse_graph(world.chain.keyframes, world.chain.edges, config));
    const int n = graph.graph.node_count() + path.graph.node_count;
    Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(n, n);
    const auto add = [&](const WeightedEdge& edge, double probability) {
      const Eigen::VectorXd across = Eigen::VectorXd::Unit(n, edge.a) - Eigen::VectorXd::Unit(n, edge.b);
      laplacian += probability * edge.weight * across * across.transpose();
    };
    for (const WeightedEdge& edge : graph.graph.edges()) add(edge, 1.0);
    for (const HallucinatedEdge& edge : path.graph.edges)
      add(edge.edge, edge.place < 0 ? 1.0 : path.places[static_cast<std::size_t>(edge.place)].probability);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian, Eigen::EigenvaluesOnly).eigenvalues().tail(n - 1);
    const double expected = criterion == Criterion::kD   ? std::exp(values.array().log().sum() / n)
                            : criterion == Criterion::kA ? n / values.cwiseInverse().sum()
                            : criterion == Criterion::kT ? values.sum() / n
                                                         : values[0];
    EXPECT_NEAR(std::get<double>(literal_optimality(graph, path)), expected, 1e-9 * expected)
        << static_cast<int>(criterion);
  }
}

}  // namespace
}  // namespace lapis::planner
