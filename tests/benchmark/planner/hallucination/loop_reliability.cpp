// Reliability of predicted loop closures, from the folders of finished runs (slam.lapis and map.lapis). It joins what
// two components left behind, so it belongs to neither of them.

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include "common/mapping/file/map_file.hpp"
#include "planner/core/hallucination/loop_reliability.hpp"
#include "slam/core/files/slam_file.hpp"
#include "slam/core/map/landmark_tiles.hpp"

namespace lapis::planner {
namespace {

struct Arguments {
  std::vector<std::string> runs;
  HallucinationConfig config;
  double stretch_m = 5.0, node_spacing_m = 1.0;
  int bins = 5;
};

FinishedRun load(const std::string& folder) {
  std::string error;
  auto slam = slam::read_slam_file(folder + "/slam.lapis", error);
  if (!slam) throw std::runtime_error(error);
  auto map = mapping::load_map(folder + "/map.lapis", error);
  if (!map) throw std::runtime_error(error);
  FinishedRun run{{}, {}, {}, InformationField(map->map.resolution_m(), map->sensor_model, {Measure::kSemantic}), {}};
  run.field.rebuild(map->map);
  run.camera = slam->state.keyframes.front().camera;
  for (const auto& keyframe : slam->state.keyframes) run.keyframes.push_back({keyframe.id, keyframe.T_map_camera});
  for (const auto& edge : slam->state.edges)
    run.edges.push_back({edge.from, edge.to, edge.information, edge.type == slam::EdgeType::kLoopClosure});
  for (auto& tile : slam::LandmarkTiles({}).update(slam::restore_map(slam->state), slam->state.graph_version))
    run.landmarks.emplace(tile.index, std::move(tile));
  return run;
}

LoopOutcomes collect(const Arguments& arguments) {
  LoopOutcomes all;
  for (const std::string& folder : arguments.runs) {
    const auto result = loop_outcomes(load(folder), arguments.config, arguments.stretch_m, arguments.node_spacing_m);
    if (const auto* error = std::get_if<GraphError>(&result)) throw std::runtime_error(folder + ": " + error->message);
    const auto& of_run = std::get<LoopOutcomes>(result);
    all.places.insert(all.places.end(), of_run.places.begin(), of_run.places.end());
    all.loops += of_run.loops;
    all.unexpected += of_run.unexpected;
  }
  return all;
}

void print_ramp(const char* what, const HallucinationConfig& config, const std::vector<LoopOutcome>& places) {
  std::printf("%s: 0 at %d landmarks, %.2f at %d; log-likelihood %.1f\n", what, config.impossible_landmarks,
              config.max_probability, config.certain_landmarks, log_likelihood(places, config));
}

void print(const LoopOutcomes& outcomes, const Arguments& arguments) {
  const HallucinationConfig& config = arguments.config;
  std::printf("%zu runs, %zu places, %d loops, %d of them at places that were not predicted\n", arguments.runs.size(),
              outcomes.places.size(), outcomes.loops, outcomes.unexpected);
  print_ramp("configured", config, outcomes.places);
  std::printf("predicted p   places  mean p  closed   share   95 %% interval\n");
  for (const ReliabilityBin& bin : reliability(outcomes.places, config, arguments.bins)) {
    if (bin.places == 0) continue;
    std::printf("%.2f to %.2f  %7d  %6.2f %7d  %6.2f   %.2f to %.2f\n", bin.from, bin.to, bin.places,
                bin.mean_probability, bin.closed, static_cast<double>(bin.closed) / bin.places, bin.low, bin.high);
  }
  if (const auto best = fit(outcomes.places, config)) print_ramp("most likely", *best, outcomes.places);
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Predicted probabilities of loop closures against what happened in finished runs");
  app.add_option("runs", arguments.runs, "folders with slam.lapis and map.lapis")->required();
  app.add_option("--impossible", arguments.config.impossible_landmarks, "planner.hallucination.impossible_landmarks");
  app.add_option("--certain", arguments.config.certain_landmarks, "planner.hallucination.certain_landmarks");
  app.add_option("--max-probability", arguments.config.max_probability, "planner.hallucination.max_probability");
  app.add_option("--place-radius", arguments.config.place_radius_m, "planner.hallucination.place_radius_m");
  app.add_option("--stretch", arguments.stretch_m, "path for which predictions are made at a time [m]");
  app.add_option("--bins", arguments.bins, "rows of the table")->check(CLI::Range(1, 100));
  CLI11_PARSE(app, argc, argv);
  print(collect(arguments), arguments);
  return 0;
}

}  // namespace
}  // namespace lapis::planner

int main(int argc, char** argv) {
  try {
    return lapis::planner::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
