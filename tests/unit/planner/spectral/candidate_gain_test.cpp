#include "planner/core/spectral/candidate_gain.hpp"

#include <gtest/gtest.h>
#include <cmath>

#include <Eigen/Cholesky>

#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

using test::make_factor;
using test::make_gain;

double log_determinant(const Eigen::MatrixXd& matrix) {
  return 2.0 * Eigen::LLT<Eigen::MatrixXd>(matrix).matrixLLT().diagonal().array().log().sum();
}

// A chain of unit weights 0..n-1.
WeightedGraph unit_chain(int n) {
  std::vector<WeightedEdge> edges;
  for (int i = 1; i < n; ++i) edges.push_back({i - 1, i, 1.0});
  return test::make_graph(n, edges);
}

std::string error_of(const HallucinatedGraph& candidate) {
  const auto result = CandidateGain::make(make_factor(unit_chain(3)), candidate);
  const auto* error = std::get_if<GraphError>(&result);
  return error == nullptr ? "" : error->message;
}

// All that a gain says, against factorisations and dense algebra of the graph with the candidate in it.
void expect_exact(const WeightedGraph& graph, const HallucinatedGraph& candidate, PlaceSet places) {
  const int n = graph.node_count(), k = candidate.node_count;
  const LaplacianFactor factor = make_factor(graph);
  const CandidateGain gain = make_gain(factor, candidate);
  const WeightedGraph whole = test::extended(graph, candidate, places);
  const LaplacianFactor with = make_factor(whole);
  const LaplacianFactor without = make_factor(test::extended(graph, candidate, kNoPlace));
  const double tolerance = 1e-9;
  EXPECT_NEAR(gain.log_trees_change(places), with.log_trees() - factor.log_trees(), tolerance);
  EXPECT_NEAR(gain.loop_gain(places), with.log_trees() - without.log_trees(), tolerance);
  EXPECT_NEAR(gain.d_optimality(places), with.d_optimality(), tolerance * with.d_optimality());
  const Eigen::MatrixXd laplacian = test::dense_laplacian(whole);
  const Eigen::MatrixXd C = laplacian.bottomRightCorner(k, k), B = laplacian.block(1, n, n - 1, k);
  const Eigen::MatrixXd old_nodes = laplacian.block(1, 1, n - 1, n - 1) - B * C.llt().solve(B.transpose());
  EXPECT_NEAR(gain.fixed_n_change(places), log_determinant(old_nodes) - factor.log_trees(), tolerance);
  for (int node = n; node < n + k; ++node) {
    const double variance = with.covariance(std::vector{node})(0, 0);
    EXPECT_NEAR(gain.variance(node, places), variance, tolerance * variance);
  }
}

TEST(CandidateGain, EqualsAFactorisationOfTheWholeGraph) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const WeightedGraph graph = test::random_graph(100, 20 * static_cast<int>(seed), seed);
    const HallucinatedGraph candidate = test::path_with_loops(100, seed);
    for (const PlaceSet places : {kNoPlace, only_place(2), only_place(0) | only_place(3), kEveryPlace}) {
      expect_exact(graph, candidate, places);
    }
  }
}

TEST(CandidateGain, AllowsCertainEdgesToManyNodesAndLoopsOfManyEdges) {
  const WeightedGraph graph = test::random_graph(50, 30, 3);
  // New nodes 50, 51, 52; the anchor, two edges from 50, a loop among new nodes, one among old ones, and parallel
  // edges.
  const HallucinatedGraph candidate{3,
                                    {{{49, 50, 3.0}},
                                     {{50, 48, 2.0}},
                                     {{50, 51, 5.0}},
                                     {{51, 52, 5.0}},
                                     {{51, 52, 1.0}},
                                     {{0, 51, 1.5}},
                                     {{52, 0, 4.0}, 1},
                                     {{52, 7, 4.0}, 1},
                                     {{50, 52, 2.0}, 2},
                                     {{3, 30, 9.0}, 63}}};
  for (const PlaceSet places : {kNoPlace, only_place(1), only_place(2), only_place(63), kEveryPlace}) {
    expect_exact(graph, candidate, places);
  }
}

TEST(CandidateGain, OfEdgesAloneNeedsNoNode) {
  const WeightedGraph graph = unit_chain(100);
  const CandidateGain gain = make_gain(make_factor(graph), {0, {{{0, 99, 1.0}, 0}}});
  // Method 6.3: closing a chain of 100 with probability 0.1, 0.3, 0.5 gains 0.46, 1.38, 2.30 nats.
  EXPECT_NEAR(gain.loop_gain(only_place(0)), std::log(100.0), 1e-10);
  EXPECT_NEAR(gain.log_trees_change(kEveryPlace), std::log(100.0), 1e-10);
  EXPECT_NEAR(gain.fixed_n_change(kEveryPlace), std::log(100.0), 1e-10);
}

TEST(CandidateGain, OfAPathWithoutLoopsIsItsWeightsAndNothingForTheOldNodes) {
  const CandidateGain gain = make_gain(make_factor(unit_chain(10)), {2, {{{9, 10, 4.0}}, {{10, 11, 8.0}}}});
  EXPECT_NEAR(gain.log_trees_change(kEveryPlace), std::log(32.0), 1e-12);
  EXPECT_EQ(gain.loop_gain(kEveryPlace), 0.0);
  EXPECT_NEAR(gain.fixed_n_change(kEveryPlace), 0.0, 1e-12);
  EXPECT_NEAR(gain.variance(11, kEveryPlace), 9.0 + 1.0 / 4.0 + 1.0 / 8.0, 1e-12);
}

TEST(CandidateGain, StartsAtAGraphOfOneNode) {
  const CandidateGain gain = make_gain(make_factor(test::make_graph(1, {})), {1, {{{0, 1, 4.0}}, {{1, 0, 5.0}, 0}}});
  EXPECT_NEAR(gain.log_trees_change(kNoPlace), std::log(4.0), 1e-14);
  EXPECT_NEAR(gain.log_trees_change(kEveryPlace), std::log(9.0), 1e-14);
  EXPECT_NEAR(gain.variance(1, kEveryPlace), 1.0 / 9.0, 1e-15);
}

TEST(CandidateGain, NamesWhatIsWrong) {
  EXPECT_EQ(error_of({0, {}}), "");
  EXPECT_EQ(error_of({1, {{{2, 3, 1.0}}}}), "");
  EXPECT_EQ(error_of({1, {{{2, 3, 0.0}}}}), "the weight of an edge is not positive and finite");
  EXPECT_EQ(error_of({1, {{{2, 4, 1.0}}}}), "an edge names a node that is not there");
  EXPECT_EQ(error_of({1, {{{2, 3, 1.0}, 64}}}), "place 64 of a loop edge is beyond 0..63");
  const std::string loose = "new nodes are not connected to the graph by certain edges";
  EXPECT_EQ(error_of({1, {{{2, 3, 1.0}, 0}}}), loose);
  EXPECT_EQ(error_of({3, {{{2, 3, 1.0}}, {{4, 5, 1.0}}}}), loose);
  for (const double weight : {0.1, 0.3, 7.7, 1e5 / 3.0}) EXPECT_EQ(error_of({2, {{{3, 4, weight}}}}), loose);
}

}  // namespace
}  // namespace lapis::planner
