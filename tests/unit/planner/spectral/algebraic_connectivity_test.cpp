#include "planner/core/spectral/algebraic_connectivity.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

using test::make_factor;
using test::make_graph;

// Closed forms: a chain 2 - 2 cos(pi/n), a ring 2 - 2 cos(2 pi/n) twice, a complete graph n times n - 1.
TEST(AlgebraicConnectivity, OfChainsRingsAndCompleteGraphs) {
  for (const int n : {2, 3, 10, 500}) {
    std::vector<WeightedEdge> chain, complete;
    for (int b = 1; b < n; ++b) {
      chain.push_back({b - 1, b, 1.0});
      for (int a = 0; a < b && n < 20; ++a) complete.push_back({a, b, 1.0});
    }
    const double of_chain = 2.0 - 2.0 * std::cos(std::numbers::pi / n);
    EXPECT_NEAR(algebraic_connectivity(make_factor(make_graph(n, chain))).value, of_chain, 1e-9 * of_chain) << n;
    if (n < 20) {
      EXPECT_NEAR(algebraic_connectivity(make_factor(make_graph(n, complete))).value, n, 1e-9 * n);
    }
    if (n < 3) continue;
    chain.push_back({n - 1, 0, 1.0});
    const double of_ring = 2.0 - 2.0 * std::cos(2.0 * std::numbers::pi / n);
    EXPECT_NEAR(algebraic_connectivity(make_factor(make_graph(n, chain))).value, of_ring, 1e-9 * of_ring) << n;
  }
}

TEST(AlgebraicConnectivity, AgreesWithDenseEigenvectors) {
  for (const auto& [n, extra] : {std::pair(30, 0), {60, 40}, {300, 100}}) {
    const WeightedGraph graph = test::random_graph(n, extra, static_cast<unsigned>(extra));
    const FiedlerPair pair = algebraic_connectivity(make_factor(graph));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(test::dense_laplacian(graph));
    EXPECT_TRUE(pair.has_converged);
    EXPECT_NEAR(pair.value, dense.eigenvalues()[1], 1e-9 * pair.value) << n;
    EXPECT_NEAR(std::abs(pair.vector.dot(dense.eigenvectors().col(1))), 1.0, 1e-9);
    EXPECT_NEAR(pair.vector.norm(), 1.0, 1e-12);
    EXPECT_NEAR(pair.vector.sum(), 0.0, 1e-9);
  }
}

TEST(AlgebraicConnectivity, ArrivesWithFewVectorsAndFromANearVector) {
  const LaplacianFactor factor = make_factor(test::three_laps(900));
  const FiedlerPair pair = algebraic_connectivity(factor);
  LanczosConfig config;
  config.basis = 4;
  const FiedlerPair restarted = algebraic_connectivity(factor, config);
  EXPECT_TRUE(restarted.has_converged);
  EXPECT_NEAR(restarted.value, pair.value, 1e-9 * pair.value);
  config.max_solves = 1;
  EXPECT_FALSE(algebraic_connectivity(factor, config).has_converged);
  EXPECT_TRUE(algebraic_connectivity(factor, config, pair.vector).has_converged);
}

TEST(AlgebraicConnectivity, IsTheSameEveryTime) {
  const LaplacianFactor factor = make_factor(test::three_laps(900));
  EXPECT_EQ(algebraic_connectivity(factor).vector, algebraic_connectivity(factor).vector);
}

}  // namespace
}  // namespace lapis::planner
