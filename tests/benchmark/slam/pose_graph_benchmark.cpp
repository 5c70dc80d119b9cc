// The pose-graph optimiser on public graphs, beside plain Ceres; see --help. Times are CPU time, medians.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "slam/core/files/pose_graph_file.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"
#include "tests/benchmark/slam/plain_ceres.hpp"
#include "tests/unit/slam/wrong_loops.hpp"

namespace lapis::slam::benchmark {
namespace {

constexpr double kTolerance = 1e-3;  // of the optimum's chi2
constexpr int kMostIterations = 1000, kMostCeresIterations = 100;

struct Options {
  std::filesystem::path folder;
  std::string only;
  int repetitions = 5;
  int seeds = 20;
  bool wrong_loops = false;
};

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

PoseGraphSnapshot read_graph(const std::filesystem::path& file) {
  std::ifstream stream(file);
  auto result = read_g2o(stream);
  if (const auto* error = std::get_if<PoseGraphFileError>(&result)) {
    throw std::runtime_error(file.string() + ": " + error->message);
  }
  return std::get<PoseGraphSnapshot>(std::move(result));
}

using Method = std::function<void(PoseGraphSnapshot& graph, int max_iterations)>;

void ours(PoseGraphSnapshot& graph, int max_iterations) {
  initialize_poses(graph);
  optimize_pose_graph({max_iterations, 1e-6, false}, graph);
}

// From the better of the file's poses and those along a spanning tree.
void plain_ceres(PoseGraphSnapshot& graph, int max_iterations) {
  PoseGraphSnapshot tree = graph;
  initialize_by_spanning_tree(tree);
  if (pose_graph_chi2(tree) < pose_graph_chi2(graph)) graph.nodes.swap(tree.nodes);
  optimize_with_plain_ceres(graph, max_iterations);
}

struct Arrival {
  bool arrives = false;
  int iterations = 0;
  double ms = 0.0, chi2 = 0.0;
};

/// Least number of iterations after which chi2 is within the tolerance, and the CPU time of such a run; of a whole run
/// where it never is.
Arrival arrival(const Method& method, const PoseGraphSnapshot& graph, double optimum, int most, int repetitions) {
  const double enough = optimum * (1.0 + kTolerance) + 1e-9;
  const auto chi2_after = [&](int iterations) {
    PoseGraphSnapshot copy = graph;
    method(copy, iterations);
    return pose_graph_chi2(copy);
  };
  Arrival result;
  result.chi2 = chi2_after(most);
  result.arrives = result.chi2 <= enough;
  int low = result.arrives ? 0 : most, high = most;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (chi2_after(middle) <= enough)
      high = middle;
    else
      low = middle + 1;
  }
  result.iterations = high;
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i) {
    PoseGraphSnapshot copy = graph;
    const double begin = cpu_ms();
    method(copy, result.iterations);
    times.push_back(cpu_ms() - begin);
  }
  result.ms = median(times);
  return result;
}

void compare(const Options& options) {
  const auto reference = options.folder / "reference.json";
  std::ifstream stream(reference);
  if (!stream) throw std::runtime_error(reference.string() + ": cannot be read; the folder has to be data/posegraph");
  std::printf("%-24s %3s %6s %6s %12s %12s %10s %5s %9s %9s %5s %9s %6s\n", "file", "dim", "nodes", "edges", "chi2",
              "reference", "above", "steps", "ours ms", "whole ms", "steps", "Ceres ms", "ratio");
  for (const auto& entry : nlohmann::json::parse(stream)) {
    const std::string file = entry["file"];
    if (entry["chi2_optimum"].is_null() || file.find(options.only) == std::string::npos) continue;
    PoseGraphSnapshot graph = read_graph(options.folder / file);
    add_missing_nodes(graph);
    const double optimum = entry["chi2_optimum"];
    const Arrival our = arrival(ours, graph, optimum, kMostIterations, options.repetitions);
    const Arrival other = arrival(plain_ceres, graph, optimum, kMostCeresIterations, options.repetitions);
    std::vector<double> times;
    for (int i = 0; i < options.repetitions; ++i) {
      PoseGraphSnapshot copy = graph;
      const double begin = cpu_ms();
      ours(copy, kMostIterations);
      times.push_back(cpu_ms() - begin);
    }
    std::printf("%-24s %3d %6zu %6zu %12.6g %12.6g %9.4f%% %5d %9.2f %9.2f %5d %9.2f ", file.c_str(),
                graph.is_planar ? 2 : 3, graph.nodes.size(), graph.edges.size(), our.chi2, optimum,
                100.0 * (our.chi2 / optimum - 1.0), our.iterations, our.ms, median(times), other.iterations, other.ms);
    const std::string ratio = other.arrives ? std::to_string(our.ms / other.ms).substr(0, 5) : "none";
    std::printf("%6s%s\n", ratio.c_str(), our.arrives ? "" : "  NOT WITHIN 0.1 %");
    std::fflush(stdout);
  }
}

void spoil(const Options& options) {
  PoseGraphSnapshot graph = read_graph(options.folder / "sphere2500.g2o");
  mark_loop_closures(graph);
  initialize_poses(graph);
  PoseGraphSnapshot clean = graph;
  optimize_pose_graph({100, 1e-6, false}, clean);
  const PoseGraphSnapshot truth = read_graph(options.folder / "gtsam_sphere2500_groundtruth.txt");
  const std::vector<Eigen::Vector3d> positions = test::chained_positions(truth);
  const double clean_ate = test::trajectory_error_m(clean, positions);
  std::printf("sphere2500, clean ATE %.4f m\n%6s %5s %10s %7s %6s %9s %9s\n", clean_ate, "wrong", "seed", "ATE m",
              "ratio", "kept", "lost", "CPU ms");
  std::fflush(stdout);
  for (const double share : {0.1, 0.2, 0.3}) {
    double worst = 0.0;
    for (int seed = 1; seed <= options.seeds; ++seed) {
      PoseGraphSnapshot spoilt = graph;
      const std::size_t first_wrong = spoilt.edges.size();
      test::add_wrong_loops(spoilt, share, static_cast<unsigned>(seed));
      const double begin = cpu_ms();
      initialize_poses_robustly(spoilt);
      const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, spoilt);
      const double ms = cpu_ms() - begin;
      int kept = 0, lost = 0;
      for (std::size_t i = 0; i < report.weights.size(); ++i) {
        if (i >= first_wrong)
          kept += report.weights[i] > 0.5 ? 1 : 0;
        else
          lost += report.weights[i] < 0.5 ? 1 : 0;
      }
      const double ate = test::trajectory_error_m(spoilt, positions);
      worst = std::max(worst, ate / clean_ate);
      std::printf("%5.0f%% %5d %10.4f %7.3f %6d %9d %9.1f\n", 100.0 * share, seed, ate, ate / clean_ate, kept, lost,
                  ms);
      std::fflush(stdout);
    }
    std::printf("%5.0f%% worst ratio %.3f\n", 100.0 * share, worst);
  }
}

}  // namespace
}  // namespace lapis::slam::benchmark

int main(int argc, char** argv) {
  using namespace lapis::slam::benchmark;
  Options options;
  CLI::App app("The pose-graph optimiser on public graphs, beside plain Ceres", "lapis_pose_graph_benchmark");
  app.add_option("folder", options.folder, "data/posegraph: g2o files and reference.json")->required();
  app.add_option("--only", options.only, "files whose name contains this");
  app.add_option("--repetitions", options.repetitions, "runs per median")->check(CLI::Range(1, 1000));
  app.add_option("--seeds", options.seeds, "of wrong loops")->check(CLI::Range(1, 1000));
  app.add_flag("--wrong-loops", options.wrong_loops, "sphere2500 with 10, 20 and 30 % wrong loops instead");
  try {
    app.parse(argc, argv);
    options.wrong_loops ? spoil(options) : compare(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "lapis_pose_graph_benchmark: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
