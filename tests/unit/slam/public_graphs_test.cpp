// The optimiser on public graphs; skips without them.
#include <gtest/gtest.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "slam/core/files/pose_graph_file.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/slam/wrong_loops.hpp"

namespace lapis::slam {
namespace {

PoseGraphSnapshot read_graph(const std::filesystem::path& file) {
  std::ifstream stream(file);
  auto result = read_g2o(stream);
  if (const auto* error = std::get_if<PoseGraphFileError>(&result)) throw std::runtime_error(error->message);
  return std::get<PoseGraphSnapshot>(std::move(result));
}

class PublicGraphs : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto found = lapis::test::find_test_data("posegraph");
    if (!found) GTEST_SKIP() << lapis::test::missing_test_data("posegraph");
    folder = *found;
  }
  std::filesystem::path folder;
};

TEST_F(PublicGraphs, ComeWithinATenthOfAPercentOfTheirOptimum) {
  std::ifstream stream(folder / "reference.json");
  int count = 0;
  for (const auto& entry : nlohmann::json::parse(stream)) {
    if (entry["chi2_optimum"].is_null()) continue;
    const std::string file = entry["file"];
    SCOPED_TRACE(file);
    PoseGraphSnapshot graph = read_graph(folder / file);
    if (add_missing_nodes(graph) == 0) {
      const double of_file = entry["chi2_initial"];
      EXPECT_NEAR(pose_graph_chi2(graph), of_file, 1e-6 * of_file);
    }
    initialize_poses(graph);
    const OptimizerReport report = optimize_pose_graph({}, graph);
    const double optimum = entry["chi2_optimum"];
    EXPECT_LT(report.final_chi2, 1.001 * optimum + 1e-9);
    EXPECT_NEAR(pose_graph_chi2(graph), report.final_chi2, 1e-6 * report.final_chi2 + 1e-12);
    ++count;
  }
  EXPECT_EQ(count, 13);
}

TEST_F(PublicGraphs, KeepTheirLoopClosuresWhenWrongOnesAreExpected) {
  for (const char* file : {"input_INTEL_g2o.g2o", "input_M3500_g2o.g2o", "sphere2500.g2o", "parking-garage.g2o"}) {
    PoseGraphSnapshot graph = read_graph(folder / file);
    mark_loop_closures(graph);
    initialize_poses_robustly(graph);
    const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, graph);
    EXPECT_EQ(report.weights, std::vector<double>(graph.edges.size(), 1.0)) << file;
  }
}

// Twenty seeds: lapis_pose_graph_benchmark --wrong-loops.
TEST_F(PublicGraphs, WrongLoopsDoNotSpoilASphere) {
  PoseGraphSnapshot graph = read_graph(folder / "sphere2500.g2o");
  mark_loop_closures(graph);
  const auto truth = test::chained_positions(read_graph(folder / "gtsam_sphere2500_groundtruth.txt"));
  PoseGraphSnapshot clean = graph;
  initialize_poses(clean);
  optimize_pose_graph({}, clean);
  const double clean_m = test::trajectory_error_m(clean, truth);
  EXPECT_LT(clean_m, 0.3);
  for (const auto& [share, seed] : {std::pair(0.1, 1U), {0.2, 2U}, {0.3, 3U}}) {
    PoseGraphSnapshot spoilt = graph;
    test::add_wrong_loops(spoilt, share, seed);
    initialize_poses_robustly(spoilt);
    const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, spoilt);
    EXPECT_TRUE(report.has_converged);
    EXPECT_LT(test::trajectory_error_m(spoilt, truth), 1.5 * clean_m) << share;
  }
}

}  // namespace
}  // namespace lapis::slam
