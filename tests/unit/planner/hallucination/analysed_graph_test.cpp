#include "planner/core/hallucination/analysed_graph.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner {
namespace {

using test::camera_at;
using test::Chain;
using test::information;

std::string error_of(const std::vector<Keyframe>& keyframes, const std::vector<KeyframeEdge>& edges) {
  const auto made = analyse_graph(keyframes, edges);
  const auto* error = std::get_if<GraphError>(&made);
  return error == nullptr ? "" : error->message;
}

TEST(AnalysedGraph, CalibratesOdometryFromItsOwnEdges) {
  const AnalysedGraph graph = Chain({camera_at(0, 0, 0), camera_at(0.5, 0, 0), camera_at(1.0, 0, 0)}).graph();
  EXPECT_NEAR(graph.odometry_weight_metres, 1e4 * 0.5, 1e-6) << "information of 1 cm and 0.01 rad after half a metre";
  EXPECT_NEAR(graph.loop_weight, 1e4, 1e-6) << "no loop yet: as half a metre";
  EXPECT_NEAR(graph.position_variance_per_resistance, 1.0, 1e-9);
}

TEST(AnalysedGraph, ParallelPathsCountTogether) {
  Chain chain({camera_at(0, 0, 0), camera_at(1, 0, 0)});
  chain.edges.push_back({10, 11, information(0.01, 0.01)});
  EXPECT_NEAR(chain.graph().odometry_weight_metres, 2e4, 1e-6);
}

TEST(AnalysedGraph, PositionVarianceIsThatOfThePositionAlone) {
  Chain chain({camera_at(0, 0, 0), camera_at(1, 0, 0)});
  chain.edges[0].information = information(0.02, 0.01);
  const AnalysedGraph graph = chain.graph();
  const double weight = *edge_weight(chain.edges[0].information, Criterion::kD);
  EXPECT_NEAR(graph.position_variance_per_resistance / weight, 0.02 * 0.02, 1e-12);
}

TEST(AnalysedGraph, WeightsAreOfTheCriterion) {
  Chain chain({camera_at(0, 0, 0), camera_at(1, 0, 0)});
  chain.edges[0].information = information(0.02, 0.01);
  GraphConfig config;
  config.criterion = Criterion::kE;
  const auto graph = std::get<AnalysedGraph>(analyse_graph(chain.keyframes, chain.edges, config));
  EXPECT_NEAR(graph.odometry_weight_metres, 2500.0, 1e-6) << "the least information, over a metre";
}

TEST(AnalysedGraph, AThinnedGraphKeepsItsLoopsAndPaths) {
  Chain chain({camera_at(0, 0, 0), camera_at(4, 0, 0), camera_at(4, 4, 0), camera_at(0, 4, 0)});
  chain.edges.push_back({10, 12, information(0.02, 0.02), true});
  chain.edges.push_back({10, 13, information(0.05, 0.05), true});
  GraphConfig config;
  config.sparsifier = Sparsifier::kLogTrees;
  config.max_edges = 4;
  const auto thinned = std::get<AnalysedGraph>(analyse_graph(chain.keyframes, chain.edges, config));
  EXPECT_EQ(thinned.loops.size(), 2u);
  EXPECT_NEAR(thinned.path_from_newest_m[0], 4.0, 1e-9);
  EXPECT_GT(position_sigma_m(thinned), position_sigma_m(chain.graph()));
}

TEST(AnalysedGraph, TheNewestPositionIsAsSureAsItsChain) {
  const AnalysedGraph graph = Chain(std::vector<geometry::Pose>(5, camera_at(0, 0, 0))).graph();
  EXPECT_NEAR(position_sigma_m(graph), 0.01 * std::sqrt(4.0), 1e-9) << "four edges of 1 cm";
}

TEST(AnalysedGraph, TheNewestPositionIsAsUnsureAsSlamSays) {
  // A heading that is off by 0.01 rad after each of ten edges moves the end of a chain of 40 m by far more than the
  // errors of the edges' own lengths do.
  std::vector<geometry::Pose> poses;
  for (int i = 0; i <= 10; ++i) poses.push_back(camera_at(4.0 * i, 0, 0));
  const Chain chain(poses);
  double variance = 0.0;
  for (int i = 0; i < 10; ++i) variance += 0.01 * 0.01 * (1.0 + std::pow(4.0 * (10 - i), 2)) / 3.0;
  const auto reported = std::get<AnalysedGraph>(analyse_graph(chain.keyframes, chain.edges, {}, variance));
  EXPECT_NEAR(position_sigma_m(reported), std::sqrt(variance), 1e-9);
  EXPECT_GT(position_sigma_m(reported), 10.0 * position_sigma_m(chain.graph()));
}

TEST(AnalysedGraph, EdgesOfItsOwnAreTheLeastUncertainty) {
  const Chain chain(std::vector<geometry::Pose>(5, camera_at(0, 0, 0)));
  const auto reported = std::get<AnalysedGraph>(analyse_graph(chain.keyframes, chain.edges, {}, 1e-8));
  EXPECT_EQ(position_sigma_m(reported), position_sigma_m(chain.graph()));
}

TEST(AnalysedGraph, PathsGoAlongEdgesAndTurnsCount) {
  Chain chain({camera_at(0, 0, 0), camera_at(4, 0, 0), camera_at(4, 4, 0), camera_at(0, 4, std::numbers::pi)});
  const AnalysedGraph open = chain.graph();
  const double turn = kMetresPerRadian * std::numbers::pi;
  EXPECT_NEAR(open.path_from_newest_m[0], 12.0 + turn, 1e-9);
  EXPECT_NEAR(open.travelled_m[3], 12.0 + turn, 1e-9);
  chain.edges.push_back({10, 13, information(0.01, 0.01), true});
  const AnalysedGraph closed = chain.graph();
  EXPECT_NEAR(closed.path_from_newest_m[0], 4.0 + turn, 1e-9);
  EXPECT_NEAR(closed.travelled_m[3], 12.0 + turn, 1e-9);
  ASSERT_EQ(closed.loops.size(), 1u);
  EXPECT_EQ(closed.loops[0].older, 0);
  EXPECT_EQ(closed.loops[0].newer, 3);
  EXPECT_NEAR(closed.loop_weight, 1e4, 1e-6);
}

TEST(AnalysedGraph, LeavesOutWhatTheNewestIsNotConnectedTo) {
  Chain chain({camera_at(0, 0, 0), camera_at(1, 0, 0), camera_at(2, 0, 0), camera_at(3, 0, 0)});
  chain.edges.erase(chain.edges.begin() + 1);
  const AnalysedGraph graph = chain.graph();
  ASSERT_EQ(graph.keyframes.size(), 2u);
  EXPECT_EQ(graph.keyframes[0].id, 12u);
  EXPECT_FALSE(graph.node_of(10));
  EXPECT_EQ(graph.node_of(13), 1);
}

TEST(AnalysedGraph, SaysWhatIsWrong) {
  const Chain chain({camera_at(0, 0, 0), camera_at(1, 0, 0)});
  EXPECT_EQ(error_of({}, {}), "the pose graph has no key-frame");
  EXPECT_EQ(error_of(chain.keyframes, {}), "the newest key-frame is not connected to any other");
  EXPECT_EQ(error_of({chain.keyframes[1]}, chain.edges), "an edge names a key-frame that the pose graph does not have");
  auto edges = chain.edges;
  edges[0].information(2, 2) = -1.0;
  EXPECT_EQ(error_of(chain.keyframes, edges), "the information of an edge is not positive definite");
}

}  // namespace
}  // namespace lapis::planner
