#include "planner/core/spectral/graph_optimality.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Eigenvalues>

#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

double value(const WeightedGraph& graph, Criterion criterion) { return std::get<double>(optimality(graph, criterion)); }

TEST(GraphOptimality, IsThatOfTheEigenvalues) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int n = 5 * static_cast<int>(seed);
    const WeightedGraph graph = test::random_graph(n, static_cast<int>(seed), seed);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(test::dense_laplacian(graph), Eigen::EigenvaluesOnly)
            .eigenvalues()
            .tail(n - 1);
    const double d = std::exp(values.array().log().sum() / n), a = n / values.cwiseInverse().sum();
    EXPECT_NEAR(value(graph, Criterion::kD), d, 1e-9 * d) << seed;
    EXPECT_NEAR(value(graph, Criterion::kA), a, 1e-9 * a) << seed;
    EXPECT_NEAR(value(graph, Criterion::kT), values.sum() / n, 1e-9 * values.sum() / n) << seed;
    EXPECT_NEAR(value(graph, Criterion::kE), values[0], 1e-9 * values[0]) << seed;
  }
}

// Two nodes: one eigenvalue, twice the weight.
TEST(GraphOptimality, OfOneEdge) {
  const WeightedGraph graph = test::make_graph(2, {{0, 1, 3.0}});
  EXPECT_DOUBLE_EQ(value(graph, Criterion::kD), std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(value(graph, Criterion::kA), 12.0);
  EXPECT_DOUBLE_EQ(value(graph, Criterion::kT), 3.0);
  EXPECT_DOUBLE_EQ(value(graph, Criterion::kE), 6.0);
}

TEST(GraphOptimality, OfOneNodeIsNone) {
  const WeightedGraph graph = test::make_graph(1, {});
  for (const Criterion criterion : {Criterion::kD, Criterion::kA, Criterion::kT, Criterion::kE})
    EXPECT_TRUE(std::holds_alternative<GraphError>(optimality(graph, criterion)));
}

}  // namespace
}  // namespace lapis::planner
