#include "slam/optimise_tool.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "common/files/atomic_file.hpp"
#include "slam/core/files/pose_graph_file.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"

namespace lapis::slam {
namespace {

// The poses of a file may be far from the optimum.
constexpr int kMaxIterations = 1000;

struct Arguments {
  std::string file, out;
  bool is_robust = false;
};

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

PoseGraphSnapshot read_graph(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  auto result = read_g2o(stream);
  if (const auto* error = std::get_if<PoseGraphFileError>(&result)) {
    throw std::runtime_error(file + ": " + error->message);
  }
  PoseGraphSnapshot graph = std::get<PoseGraphSnapshot>(std::move(result));
  if (graph.edges.empty()) {
    throw std::runtime_error(file + ": has no edges; expected g2o text (EDGE_SE3:QUAT or EDGE_SE2)");
  }
  return graph;
}

void optimise(const Arguments& arguments, std::ostream& out) {
  PoseGraphSnapshot graph = read_graph(arguments.file);
  const bool has_poses = add_missing_nodes(graph) == 0;
  mark_loop_closures(graph);
  if (has_poses) out << "chi2 of file  " << std::setprecision(10) << pose_graph_chi2(graph) << '\n';
  const double begin = cpu_seconds();
  arguments.is_robust ? initialize_poses_robustly(graph) : initialize_poses(graph);
  const OptimizerReport report = optimize_pose_graph({kMaxIterations, 1e-6, arguments.is_robust}, graph);
  const double seconds = cpu_seconds() - begin;
  if (!arguments.out.empty()) {
    std::ostringstream text;
    write_g2o(text, graph);
    files::replace_text(arguments.out, text.str());
  }
  out << "initial chi2  " << report.initial_chi2 << "\nfinal chi2    " << report.final_chi2 << "\niterations    "
      << report.iterations << (report.has_converged ? "" : " (not converged)") << "\nCPU time      "
      << std::setprecision(3) << seconds << " s\n";
  if (!arguments.is_robust) return;
  const auto out_of = std::count(report.weights.begin(), report.weights.end(), 0.0);
  out << "edges without weight: " << out_of << " of " << graph.edges.size() << '\n';
}

}  // namespace

void add_file_tools(CLI::App& app, std::ostream& out) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* tool =
      app.add_subcommand("optimise", "optimise the pose graph in a g2o file, and print chi2 before and after");
  tool->add_option("file", arguments->file, "g2o text file with EDGE_SE3:QUAT or EDGE_SE2; vertices are optional")
      ->required();
  tool->add_option("--out", arguments->out, "g2o file for the optimised graph; default: none is written");
  tool->add_flag("--robust", arguments->is_robust,
                 "remove the weight of wrong loop closures (edges between key-frames that do not follow one another)");
  tool->callback([arguments, &out] { optimise(*arguments, out); });
}

}  // namespace lapis::slam
