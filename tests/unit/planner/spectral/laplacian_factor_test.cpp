#include "planner/core/spectral/laplacian_factor.hpp"

#include <gtest/gtest.h>
#include <cmath>

#include <Eigen/Cholesky>

#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

using test::make_factor;
using test::make_graph;

// By hand: the product of a path's weights; sums over spanning trees; Cayley's n^(n-2).
TEST(LaplacianFactor, CountsSpanningTrees) {
  const LaplacianFactor path = make_factor(make_graph(4, {{0, 1, 2.0}, {1, 2, 3.0}, {2, 3, 5.0}}));
  EXPECT_NEAR(std::exp(path.log_trees()), 30.0, 30.0 * 1e-14);
  EXPECT_NEAR(path.d_optimality(), 3.309750919646873, 1e-14);
  const LaplacianFactor ring = make_factor(make_graph(4, {{0, 1, 2.0}, {1, 2, 3.0}, {2, 3, 5.0}, {3, 0, 7.0}}));
  EXPECT_NEAR(std::exp(ring.log_trees()), 247.0, 247.0 * 1e-14);
  EXPECT_NEAR(ring.d_optimality(), 5.606466560232338, 1e-14);
  for (const int n : {1, 2, 3, 4, 9}) {
    std::vector<WeightedEdge> edges;
    for (int b = 0; b < n; ++b) {
      for (int a = 0; a < b; ++a) edges.push_back({a, b, 1.0});
    }
    const double log_trees = make_factor(make_graph(n, edges)).log_trees();
    EXPECT_NEAR(log_trees, (n - 2) * std::log(n), 1e-13) << n;
  }
}

TEST(LaplacianFactor, DoesNotOverflowWhereTheNumberOfTreesDoes) {
  std::vector<WeightedEdge> edges;
  for (int i = 0; i < 20000; ++i) edges.push_back({i, i + 1, 1e6});
  const LaplacianFactor factor = make_factor(make_graph(20001, edges));
  EXPECT_NEAR(factor.log_trees(), 20000 * std::log(1e6), 1e-9 * factor.log_trees());
}

TEST(LaplacianFactor, AgreesWithDenseAlgebra) {
  for (const auto& [n, extra] : {std::pair(2, 0), {5, 3}, {40, 0}, {60, 50}, {300, 900}}) {
    SCOPED_TRACE(n);
    const WeightedGraph graph = test::random_graph(n, extra, static_cast<unsigned>(n));
    const LaplacianFactor factor = make_factor(graph);
    const Eigen::MatrixXd reduced = test::dense_laplacian(graph).bottomRightCorner(n - 1, n - 1);
    const Eigen::LLT<Eigen::MatrixXd> dense(reduced);
    EXPECT_NEAR(factor.log_trees(), 2.0 * dense.matrixLLT().diagonal().array().log().sum(), 1e-11 * n);
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
    inverse.bottomRightCorner(n - 1, n - 1) = dense.solve(Eigen::MatrixXd::Identity(n - 1, n - 1));
    const std::vector<int> nodes{n - 1, 0, n / 2, 1, n - 1};
    const Eigen::MatrixXd covariance = factor.covariance(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (std::size_t j = 0; j < nodes.size(); ++j) {
        EXPECT_NEAR(covariance(static_cast<int>(i), static_cast<int>(j)), inverse(nodes[i], nodes[j]), 1e-11);
      }
    }
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0);
    EXPECT_LT((factor.solve(right) - inverse * right).norm(), 1e-11 * (inverse * right).norm());
  }
}

TEST(LaplacianFactor, KnowsTheResistanceOfAChain) {
  std::vector<WeightedEdge> edges;
  double resistance = 0.0;
  for (int i = 0; i < 1000; ++i) {
    edges.push_back({i, i + 1, 1.0 + i});
    resistance += 1.0 / (1.0 + i);
  }
  const std::vector<int> end{1000};
  EXPECT_NEAR(make_factor(make_graph(1001, edges)).covariance(end)(0, 0), resistance, 1e-10);
}

TEST(LaplacianFactor, SaysWhereWeightsAreTooUnequal) {
  const auto result = LaplacianFactor::make(make_graph(3, {{0, 1, 1e-12}, {1, 2, 1e12}}));
  ASSERT_TRUE(std::holds_alternative<GraphError>(result));
  EXPECT_EQ(std::get<GraphError>(result).message,
            "the Laplacian cannot be factorised: weights differ by too many orders of magnitude");
}

TEST(LaplacianFactor, IsTheSameEveryTime) {
  const WeightedGraph graph = test::three_laps(3000);
  const LaplacianFactor first = make_factor(graph), second = make_factor(graph);
  EXPECT_EQ(first.log_trees(), second.log_trees());
  const std::vector<int> nodes{2999, 17, 1500};
  EXPECT_EQ(first.covariance(nodes), second.covariance(nodes));
}

}  // namespace
}  // namespace lapis::planner
