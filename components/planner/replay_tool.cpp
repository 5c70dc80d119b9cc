#include "planner/replay_tool.hpp"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "common/files/atomic_file.hpp"
#include "common/geometry/camera_mount.hpp"
#include "planner/decision_log.hpp"

namespace lapis::planner {
namespace {

constexpr const char* kFile = "replayed.csv";

RecordedSituation read_situation(const std::string& file) {
  std::string error;
  const auto bytes = files::read_file(file, error);
  if (!bytes) throw std::runtime_error(error);
  auto situation = decode_situation(*bytes, error);
  if (!situation) throw std::runtime_error(file + ": " + error);
  return std::move(*situation);
}

/// The number, or a dash for terms that the method does not ask for.
std::string number(bool is_known, double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return is_known ? text : "-";
}

void print(const Decision& decision) {
  std::printf("  %-11s %8s %16s %8s %10s %10s %6s %12s %8s %11s\n", "kind", "frontier", "goal [m]", "cost [m]",
              "MI [nats]", "goal's MI", "places", "D", "unknown", "utility");
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    const Candidate& c = decision.candidates[i];
    std::printf("%c %-11s %8u %7.2f, %7.2f ", decision.chosen == i ? '>' : ' ', name_of(c.kind), c.frontier,
                c.goal.p_map.x(), c.goal.p_map.y());
    if (!c.is_open()) {
      std::printf("%s\n", text_of(c.rejection).c_str());
      continue;
    }
    const Asks& known = decision.known;
    std::printf("%8.2f %10s %10s %6s %12s %8s %11.5g\n", c.value.cost_m,
                number(known.path_information, c.value.path_information, 1).c_str(),
                number(known.goal_information, c.value.goal_information, 1).c_str(),
                number(known.spectrum, static_cast<double>(c.loops.size()), 0).c_str(),
                number(known.spectrum, c.value.optimality, 4).c_str(),
                number(known.unknown_share, c.value.unknown_share, 3).c_str(), c.utility);
  }
  if (!decision.problem.empty()) std::printf("pose graph: %s\n", decision.problem.c_str());
  if (!decision.chosen) std::printf("nothing is chosen; %s\n", decision.leftover.text().c_str());
}

}  // namespace

Decision decide_again(const RecordedSituation& situation, const PlannerComponentConfig& config) {
  const mapping::VoxelMap& map = situation.map.map;
  Surroundings surroundings(config.surroundings, situation.map.sensor_model, map.resolution_m());
  surroundings.update_map(map, map.sorted_blocks());
  surroundings.set_marks(situation.marks);
  const View view(view_config(config));
  DecisionInput input;
  input.surroundings = &surroundings;
  input.view = &view;
  input.T_base_camera = geometry::T_base_camera(robot::camera_mount(config.robot.camera));
  input.robot = situation.robot;
  input.memory = situation.memory;
  input.config = config.decision;
  if (situation.graph) {
    input.graph = GraphMessage{0, 0, situation.graph->keyframes, situation.graph->edges};
    input.position_variance_m2 = situation.graph->position_variance_m2;
    input.landmarks = situation.graph->landmarks;
  }
  return make_decision(std::move(input)).decision;
}

std::optional<int> run_replay(const PlannerComponentConfig& config) {
  if (config.replay.empty()) return std::nullopt;
  const RecordedSituation situation = read_situation(config.replay);
  const auto noted = [&](const char* what) {
    const auto note = situation.map.provenance.find(what);
    return note == situation.map.provenance.end() ? std::string("?") : note->second;
  };
  const Decision decision = decide_again(situation, completed(config));
  std::printf("decision %s, at %s s, made by %s, by method %s:\n", noted("decision").c_str(), noted("stamp").c_str(),
              noted("method").c_str(), config.method.c_str());
  print(decision);
  if (config.output_dir.empty()) return 0;
  files::require_writable_folder(config.output_dir, "planner.output_dir");
  DecisionLog log((std::filesystem::path(config.output_dir) / kFile).string(), config.compared_methods,
                  config.surroundings.compared_priors);
  if (!log.write(decision, std::nullopt, 1, config.method, {}))
    throw std::runtime_error(config.output_dir + " is full");
  return 0;
}

}  // namespace lapis::planner
