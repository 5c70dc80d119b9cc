// The public graphs of up to 2000 nodes against all their eigenvalues, by dense algebra; skips without the graphs.
#include <gtest/gtest.h>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "planner/core/spectral/algebraic_connectivity.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/planner/spectral/public_graphs.hpp"
#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

TEST(PublicGraphs, HaveTheirDenseSpectra) {
  const auto folder = lapis::test::find_test_data("posegraph");
  if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("posegraph");
  for (const char* file :
       {"gtsam_toyExample.g2o", "gtsam_Klaus3.g2o", "gtsam_w100.graph", "smallGrid3D.g2o", "kimera_rpgo_robot_a.g2o",
        "kimera_rpgo_robot_b.g2o", "CSAIL.g2o", "input_INTEL_g2o.g2o", "parking-garage.g2o", "mac_intel.g2o"}) {
    SCOPED_TRACE(file);
    const WeightedGraph graph = test::weigh(test::read_edges(*folder / file), "det_root");
    const int n = graph.node_count();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(test::dense_laplacian(graph), Eigen::EigenvaluesOnly);
    const double log_product = dense.eigenvalues().tail(n - 1).array().log().sum();
    const LaplacianFactor factor = test::make_factor(graph);
    const double d_optimality = std::exp(log_product / n);
    EXPECT_NEAR(factor.d_optimality(), d_optimality, 1e-9 * d_optimality);
    EXPECT_NEAR(factor.log_trees(), log_product - std::log(n), 1e-9 * factor.log_trees());
    const double lambda2 = dense.eigenvalues()[1];
    EXPECT_NEAR(algebraic_connectivity(factor).value, lambda2, 1e-9 * lambda2);
  }
}

}  // namespace
}  // namespace lapis::planner
