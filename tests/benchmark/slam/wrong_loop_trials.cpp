#include "tests/benchmark/slam/wrong_loop_trials.hpp"

#include <algorithm>
#include <cstdio>

#include "slam/core/graph/graph_correction.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "tests/unit/slam/wrong_loops.hpp"

namespace lapis::slam::benchmark {
namespace {

struct Trial {
  double error_m = 0.0;
  int kept = 0;  // wrong loops
  int lost = 0;  // true ones
};

// Edges from `first_wrong` on are wrong loops.
Trial correct(PoseGraphSnapshot graph, std::size_t first_wrong, const std::vector<Eigen::Vector3d>& truth) {
  const GraphCorrection correction = correct_graph(graph);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) graph.nodes[i].T_map_camera = correction.T_map_camera[i];
  Trial trial;
  trial.error_m = test::trajectory_error_m(graph, truth);
  for (std::size_t i = 0; i < correction.weights.size(); ++i) {
    const bool stays = correction.weights[i] >= 0.5;
    if (i >= first_wrong && stays) ++trial.kept;
    if (i < first_wrong && !stays) ++trial.lost;
  }
  return trial;
}

void print_trials(const char* start, const PoseGraphSnapshot& graph, const std::vector<Eigen::Vector3d>& truth,
                  int seeds) {
  const Trial clean = correct(graph, graph.edges.size(), truth);
  for (const double share : {0.1, 0.2, 0.3}) {
    std::vector<double> ratios;
    Trial sum;
    std::size_t wrong = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      PoseGraphSnapshot spoilt = graph;
      test::add_wrong_loops(spoilt, share, static_cast<unsigned>(seed));
      wrong = spoilt.edges.size() - graph.edges.size();
      const Trial trial = correct(spoilt, graph.edges.size(), truth);
      ratios.push_back(trial.error_m / clean.error_m);
      sum.kept += trial.kept;
      sum.lost += trial.lost;
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf(
        "  wrong loops %2.0f %% (%zu), from the %s: ATE worst %.3f, median %.3f times the clean %.2f cm; wrong ones "
        "kept "
        "%.2f, true ones lost %.2f (clean: %d) a run\n",
        100.0 * share, wrong, start, ratios.back(), ratios[ratios.size() / 2], 100.0 * clean.error_m,
        sum.kept / static_cast<double>(seeds), sum.lost / static_cast<double>(seeds), clean.lost);
    std::fflush(stdout);
  }
}

}  // namespace

void print_wrong_loop_trials(const PoseGraphSnapshot& graph, const std::vector<Eigen::Vector3d>& truth, int seeds) {
  const bool has_loops = std::any_of(graph.edges.begin(), graph.edges.end(),
                                     [](const PoseGraphEdge& edge) { return edge.type == EdgeType::kLoopClosure; });
  if (!has_loops) {
    std::printf("  wrong loops: none added, because the graph has no loop whose information they could take\n");
    return;
  }
  print_trials("map", graph, truth, seeds);
  PoseGraphSnapshot chained = graph;
  initialize_by_spanning_tree(chained);
  print_trials("chain", chained, truth, seeds);
}

}  // namespace lapis::slam::benchmark
