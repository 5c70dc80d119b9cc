#include "planner/core/spectral/sparsification.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "planner/core/spectral/algebraic_connectivity.hpp"
#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

using Objective = std::function<double(const LaplacianFactor&)>;
using Method = std::function<std::variant<Sparsification, GraphError>(const SparsificationProblem&)>;

double connectivity(const LaplacianFactor& factor) { return algebraic_connectivity(factor).value; }
double log_trees(const LaplacianFactor& factor) { return factor.log_trees(); }
std::variant<Sparsification, GraphError> mac(const SparsificationProblem& problem) {
  return maximize_connectivity(problem);
}

SparsificationProblem chain_with_candidates(int nodes, int candidates, int kept, unsigned seed) {
  SparsificationProblem problem{nodes, test::random_graph(nodes, 0, seed).edges(), {}, kept};
  std::mt19937 random(seed);
  const auto below = [&](int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); };
  for (int k = 0; k < candidates; ++k) {
    const int a = below(nodes);
    problem.candidates.push_back({a, (a + 1 + below(nodes - 1)) % nodes, 0.5 + below(100) / 10.0});
  }
  return problem;
}

double value_of(const SparsificationProblem& problem, const std::vector<int>& kept, const Objective& objective) {
  std::vector<WeightedEdge> edges = problem.fixed;
  for (const int k : kept) edges.push_back(problem.candidates[static_cast<std::size_t>(k)]);
  return objective(test::make_factor(test::make_graph(problem.node_count, edges)));
}

// Over all choices.
double best_value(const SparsificationProblem& problem, const Objective& objective) {
  std::vector<bool> chosen(problem.candidates.size(), false);
  std::fill_n(chosen.begin(), problem.kept, true);
  double best = 0.0;
  do {
    std::vector<int> kept;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (chosen[k]) kept.push_back(static_cast<int>(k));
    }
    best = std::max(best, value_of(problem, kept, objective));
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return best;
}

// The share of the best gain over the fixed edges, checked for what is promised.
double share_of_best(const Method& method, const Objective& objective, unsigned seed) {
  const SparsificationProblem problem = chain_with_candidates(15, 10, 4, seed);
  const auto result = std::get<Sparsification>(method(problem));
  EXPECT_EQ(std::ssize(result.kept), problem.kept);
  EXPECT_TRUE(std::is_sorted(result.kept.begin(), result.kept.end()));
  EXPECT_NEAR(result.value, value_of(problem, result.kept, objective), 1e-9 * result.value);
  const double best = best_value(problem, objective);
  EXPECT_LE(result.value, best * (1.0 + 1e-9));
  EXPECT_GE(result.upper_bound, best * (1.0 - 1e-9));
  const double none = value_of(problem, {}, objective);
  return (result.value - none) / (best - none);
}

TEST(Sparsification, ByMacIsNearTheBestChoiceAndBelowItsBound) {
  double mean = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) mean += share_of_best(mac, connectivity, seed) / 10.0;
  EXPECT_GT(mean, 0.9);
}

TEST(Sparsification, ByGreedyLogDetKeepsItsPromise) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_GE(share_of_best(maximize_log_trees, log_trees, seed), 1.0 - std::exp(-1.0)) << seed;
  }
}

// More picks than between two factorisations.
TEST(Sparsification, ByGreedyLogDetIsThatOfPlainGreed) {
  SparsificationProblem problem = chain_with_candidates(40, 80, 66, 5);
  const auto result = std::get<Sparsification>(maximize_log_trees(problem));
  std::vector<int> kept;
  while (std::ssize(kept) < problem.kept) {
    int best = -1;
    double most = 0.0;
    for (int k = 0; k < std::ssize(problem.candidates); ++k) {
      if (std::find(kept.begin(), kept.end(), k) != kept.end()) continue;
      kept.push_back(k);
      const double value = value_of(problem, kept, log_trees);
      kept.pop_back();
      if (value > most) {
        most = value;
        best = k;
      }
    }
    kept.push_back(best);
  }
  std::sort(kept.begin(), kept.end());
  EXPECT_EQ(result.kept, kept);
}

TEST(Sparsification, KeepsNothingOrEverythingWhereAsked) {
  SparsificationProblem problem = chain_with_candidates(20, 12, 0, 2);
  for (const Method& method : {Method(mac), Method(maximize_log_trees)}) {
    problem.kept = 0;
    EXPECT_TRUE(std::get<Sparsification>(method(problem)).kept.empty());
    problem.kept = 12;
    EXPECT_EQ(std::ssize(std::get<Sparsification>(method(problem)).kept), 12);
  }
}

TEST(Sparsification, IsTheSameEveryTime) {
  const SparsificationProblem problem = chain_with_candidates(200, 100, 30, 9);
  for (const Method& method : {Method(mac), Method(maximize_log_trees)}) {
    const auto first = std::get<Sparsification>(method(problem)), second = std::get<Sparsification>(method(problem));
    EXPECT_EQ(first.kept, second.kept);
    EXPECT_EQ(first.upper_bound, second.upper_bound);
  }
}

TEST(Sparsification, NamesWhatIsWrong) {
  for (const Method& method : {Method(mac), Method(maximize_log_trees)}) {
    SparsificationProblem problem = chain_with_candidates(20, 12, 13, 2);
    EXPECT_EQ(std::get<GraphError>(method(problem)).message, "cannot keep 13 of 12 candidate edges");
    problem.kept = 3;
    problem.fixed.pop_back();
    EXPECT_EQ(std::get<GraphError>(method(problem)).message, "the graph is not connected");
    problem.candidates[5] = {3, 4, 0.0};
    EXPECT_EQ(std::get<GraphError>(method(problem)).message, "the weight of an edge is not positive and finite");
  }
}

WeightedGraph sparse(const WeightedGraph& graph, Sparsifier sparsifier, int max_edges) {
  return std::get<WeightedGraph>(sparsify(graph, sparsifier, max_edges));
}

TEST(Sparsify, LeavesSmallGraphsAsTheyAre) {
  const WeightedGraph graph = test::three_laps(60);
  const int edges = static_cast<int>(graph.edges().size());
  EXPECT_EQ(sparse(graph, Sparsifier::kNone, 1).edges().size(), graph.edges().size());
  EXPECT_EQ(sparse(graph, Sparsifier::kLogTrees, edges).edges().size(), graph.edges().size());
  EXPECT_EQ(std::ssize(sparse(graph, Sparsifier::kLogTrees, edges - 1).edges()), edges - 1);
}

TEST(Sparsify, KeepsTheHeaviestSpanningTree) {
  const WeightedGraph square = test::make_graph(4, {{0, 1, 1.0}, {1, 2, 5.0}, {2, 3, 4.0}, {0, 3, 3.0}, {0, 2, 2.0}});
  for (const Sparsifier sparsifier : {Sparsifier::kMac, Sparsifier::kLogTrees}) {
    const auto tree = sparse(square, sparsifier, 1).edges();
    ASSERT_EQ(tree.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_GE(tree[i].weight, 3.0);
  }
}

// Share of the pairs of candidates that come in the same order of their loops' worth, in the whole graph and in the
// thinned one.
double share_in_order(const WeightedGraph& whole, const WeightedGraph& thinned) {
  const LaplacianFactor factors[] = {test::make_factor(whole), test::make_factor(thinned)};
  std::vector<std::array<double, 2>> gains;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const HallucinatedGraph path = test::path_with_loops(whole.node_count(), seed);
    gains.push_back({test::make_gain(factors[0], path).loop_gain(kEveryPlace),
                     test::make_gain(factors[1], path).loop_gain(kEveryPlace)});
  }
  int pairs = 0, in_order = 0;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs)
      in_order += (gains[i][0] < gains[j][0]) == (gains[i][1] < gains[j][1]) ? 1 : 0;
  }
  return static_cast<double>(in_order) / pairs;
}

// Half of what is beside the tree is taken away.
TEST(Sparsify, CandidatesKeepTheirOrder) {
  const WeightedGraph graph = test::three_laps(400);
  const int half = (static_cast<int>(graph.edges().size()) + graph.node_count()) / 2;
  for (const Sparsifier sparsifier : {Sparsifier::kMac, Sparsifier::kLogTrees}) {
    const double share = share_in_order(graph, sparse(graph, sparsifier, half));
    RecordProperty(sparsifier == Sparsifier::kMac ? "mac" : "log_det", std::to_string(share));
    EXPECT_GE(share, 0.9);
  }
}

}  // namespace
}  // namespace lapis::planner
