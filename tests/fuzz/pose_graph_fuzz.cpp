// Reads a pose graph, optimises it for a moment, and reads what was written of it.

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "fuzz_files.hpp"
#include "slam/core/files/pose_graph_file.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"

namespace {

using namespace lapis::slam;

// What the optimiser may be given here: its time grows with the size, which is not what is looked for.
constexpr std::size_t kMaxElements = 60;

void require(bool condition) {
  if (!condition) std::abort();
}

void require_valid(const PoseGraphSnapshot& graph) {
  for (const PoseGraphNode& node : graph.nodes) require(lapis::geometry::is_valid(node.T_map_camera));
  for (const PoseGraphEdge& edge : graph.edges) {
    require(lapis::geometry::is_valid(edge.T_from_to) && edge.information.allFinite());
  }
}

void optimize(PoseGraphSnapshot graph, bool is_robust) {
  add_missing_nodes(graph);
  mark_loop_closures(graph);
  is_robust ? initialize_poses_robustly(graph) : initialize_poses(graph);
  require_valid(graph);
  const OptimizerReport report = optimize_pose_graph({5, 1e-6, is_robust}, graph);
  require(std::isfinite(report.initial_chi2) && std::isfinite(report.final_chi2));
  require_valid(graph);
  const GraphMarginals marginals = graph_marginals(graph, report.weights);
  for (const auto& covariance : marginals.covariances) require(!covariance || covariance->allFinite());
  for (const auto& covariance : marginals.with_newest) require(covariance.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  const auto result = read_g2o(stream);
  if (const auto* error = std::get_if<PoseGraphFileError>(&result)) {
    require(error->message.rfind("line ", 0) == 0);
    return 0;
  }
  const auto& graph = std::get<PoseGraphSnapshot>(result);
  require_valid(graph);
  if (graph.edges.empty() || graph.edges.size() + graph.nodes.size() > kMaxElements) return 0;
  std::stringstream written;
  write_g2o(written, graph);
  require(std::holds_alternative<PoseGraphSnapshot>(read_g2o(written)));
  optimize(graph, false);
  optimize(graph, true);
  return 0;
}
