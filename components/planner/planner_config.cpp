#include "planner/planner_config.hpp"

#include "planner/core/methods/consolidation.hpp"

namespace lapis::planner {
namespace {

Measure measure_of(const std::string& name) {
  if (name == "shannon") return Measure::kShannon;
  return name == "csqmi" ? Measure::kCsqmi : Measure::kSemantic;
}

Criterion criterion_of(const std::string& name) {
  if (name == "a") return Criterion::kA;
  if (name == "t") return Criterion::kT;
  return name == "e" ? Criterion::kE : Criterion::kD;
}

Sparsifier sparsifier_of(const std::string& name) {
  if (name == "mac") return Sparsifier::kMac;
  return name == "log_det" ? Sparsifier::kLogTrees : Sparsifier::kNone;
}

}  // namespace

std::vector<std::string> all_methods() {
  std::vector<std::string> names = method_names();
  names.insert(names.begin(), "lapis");
  return names;
}

std::vector<std::string> all_consolidations() {
  std::vector<std::string> names = consolidation_names();
  names.insert(names.begin(), "none");
  return names;
}

std::vector<std::string> comparable_methods() {
  std::vector<std::string> names = method_names();
  std::erase_if(names, [](const std::string& name) { return make_method(name)->has_own_candidates(); });
  return names;
}

PlannerComponentConfig completed(PlannerComponentConfig config) {
  config.decision.method = make_method(config.method, config.methods);
  config.decision.compared_methods.clear();
  for (const std::string& name : config.compared_methods)
    config.decision.compared_methods.push_back(make_method(name, config.methods));
  config.consolidation = make_consolidation(config.then, config.methods);
  config.explorer.consolidates = config.consolidation != nullptr;
  config.surroundings.ray.measure = measure_of(config.measure);
  config.decision.graph.criterion = criterion_of(config.criterion);
  config.decision.graph.sparsifier = sparsifier_of(config.sparsifier);
  config.surroundings.grid.footprint_radius_m = config.robot.radius_m;
  config.surroundings.grid.band = {config.robot.obstacle_min_height_m, config.robot.obstacle_max_height_m};
  config.decision.hallucination.covisibility.max_range_m = config.robot.sensing_range_m;
  config.explorer.path = config.decision.path;
  return config;
}

ViewConfig view_config(const PlannerComponentConfig& config) {
  ViewConfig view;
  view.camera = robot::pinhole_camera(config.robot.camera);
  view.columns = config.view_columns;
  view.rows = config.view_rows;
  view.range_m = config.robot.sensing_range_m;
  return view;
}

}  // namespace lapis::planner
