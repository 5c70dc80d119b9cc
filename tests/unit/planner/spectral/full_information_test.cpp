// The paper's central approximation on recorded graphs: D of the weighted Laplacian for that of the whole information
// matrix. Skips without the graphs.
#include "tests/unit/planner/spectral/full_information.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "slam/core/files/pose_graph_file.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

using test::compare_with_full_information;

// Information that is the same for every edge in a common frame: the whole matrix is a Kronecker product then, and the
// two determinants differ by a constant.
TEST(FullInformation, IsWhatTheLaplacianSaysWhenAllEdgesAreAlike) {
  const WeightedGraph graph = test::random_graph(40, 20, 3);
  slam::PoseGraphSnapshot snapshot;
  for (int i = 0; i < 40; ++i)
    snapshot.nodes.push_back({static_cast<std::uint64_t>(i), {}, geometry::Pose::Identity()});
  for (const WeightedEdge& edge : graph.edges()) {
    slam::PoseGraphEdge& added = snapshot.edges.emplace_back();
    added.from = static_cast<std::uint64_t>(edge.a);
    added.to = static_cast<std::uint64_t>(edge.b);
    added.information = edge.weight * geometry::Matrix6d::Identity();
  }
  const auto comparison = compare_with_full_information(snapshot);
  ASSERT_FALSE(comparison.loops.empty());
  for (const auto& values : {comparison.loops, comparison.growth}) {
    for (const auto& value : values) EXPECT_NEAR(value.full, value.laplacian, 1e-9);
  }
  EXPECT_NEAR(rank_correlation(comparison.loops), 1.0, 1e-12);
}

// Where the information of edges differs in shape, and far from the first key-frame, where a heading moves what is far
// away, weights are what is left of it: docs/evaluation.md has more graphs, and what came of them.
TEST(FullInformation, OfPublicGraphsRanksLoopsMoreOrLessAsTheLaplacianDoes) {
  const auto folder = lapis::test::find_test_data("posegraph");
  if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("posegraph");
  const std::pair<const char*, double> least[] = {
      {"mac_intel.g2o", 0.95}, {"input_INTEL_g2o.g2o", 0.8}, {"smallGrid3D.g2o", 0.5}};
  for (const auto& [file, correlation] : least) {
    std::ifstream stream(*folder / file);
    const auto graph = std::get<slam::PoseGraphSnapshot>(slam::read_g2o(stream));
    const auto comparison = compare_with_full_information(graph);
    EXPECT_GT(rank_correlation(comparison.loops), correlation) << file;
    EXPECT_GT(rank_correlation(comparison.growth), 0.9) << file;
  }
}

}  // namespace
}  // namespace lapis::planner
