// Explorations of any building at true poses, without images, slam and DDS, a row each.
//   lapis_explorations --scenes office_1,clinic_3 --methods nearest,mi_only --set planner.keep_factor=1
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/config/yaml.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/planner/exploration/exploration.hpp"

namespace lapis::planner::benchmark {
namespace {

struct Options {
  std::vector<std::string> scenes{"apartment"};
  std::vector<std::string> methods{"nearest"};
  std::vector<int> seeds{1};
  std::vector<std::string> overrides;
  double longest_s = 300.0;
  bool with_moments = false;
  std::string paths_file;
  int known_places = 0;
};

ExplorationSetting setting_of(const Options& options, const std::string& scene, int seed, const std::string& method) {
  ExplorationSetting setting;
  setting.longest_s = options.longest_s;
  setting.known_places = options.known_places;
  robot::RobotDescription robot;
  robot.camera.width = 320;
  robot.camera.height = 180;
  setting.controller.method.local_map.stride = 2;  // as many points as of a whole image
  config::Schema schema;
  schema("simulator", setting.simulated);
  schema("robot", robot);
  schema("planner", setting.planner);
  schema("controller", setting.controller);
  for (const std::string& assignment : options.overrides) config::apply_override(schema, assignment);
  config::apply_override(schema, "planner.method=" + method);
  config::check(schema);
  setting.simulated.scene = scene;
  setting.simulated.seed = seed;
  setting.simulated.robot = setting.planner.robot = setting.controller.robot = robot;
  setting.planner = completed(setting.planner);
  setting.controller = controller::completed(setting.controller);
  return setting;
}

const char* name_of(State state) {
  if (state == State::kDone) return "DONE";
  if (state == State::kGaveUp) return "GAVE_UP";
  return state == State::kFailed ? "FAILED" : "EXPLORING";
}

/// Closed without a name.
std::ofstream begin_paths(const std::string& file) {
  std::ofstream paths;
  if (file.empty()) return paths;
  paths.open(file);
  paths << "scene,method,seed,begin_s,ended_kind,ended_s,ended_cost_m,ended_promised_nats,ended_driven_nats,"
           "ended_gained_nats\n";
  if (!paths) throw std::runtime_error(file + " cannot be written");
  return paths;
}

void write_paths(const Exploration& e, const std::string& of, std::ofstream& paths) {
  if (!paths.is_open()) return;
  const auto write = [&](const DrivenPath& path, const std::string& kind) {
    paths << of << ',' << path.begin.seconds() << ',' << kind << ',' << (path.end - path.begin).seconds() << ','
          << path.cost_m << ',' << path.promised_nats << ',' << path.driven_nats << ',' << path.gained_nats << '\n';
  };
  for (const DrivenPath& path : e.paths) write(path, name_of(path.kind));
  for (const DrivenPath& path : e.known_paths) write(path, "known");
  for (const DrivenPath& path : e.driven_paths) write(path, "driven");
  paths.flush();
}

void print_moments(const char* what, const std::vector<ExplorationMoment>& moments) {
  for (const ExplorationMoment& m : moments) {
    std::printf("    %s %6.1f s  %5.1f %%  %6.2f %6.2f %4.0f dg  %s\n", what, m.t_s, 100.0 * m.explored_share,
                m.robot.p_map.x(), m.robot.p_map.y(), m.robot.yaw_rad * 180.0 / std::numbers::pi, m.doing.c_str());
  }
}

void print(const Exploration& e, const Options& options) {
  const ExplorationMoment& end = e.moments.back();
  std::printf(
      "%6.1f s %-9s | explored %5.1f %% | 80 %% after %5.0f s, 90 %% %5.0f s, 95 %% %5.0f s | path %6.1f m | "
      "contacts %zu | decisions %4d, %5.1f ms | left:",
      end.t_s, name_of(e.state), 100.0 * end.explored_share, e.time_to_s(0.8), e.time_to_s(0.9), e.time_to_s(0.95),
      e.path_m, e.contacts.size(), e.decisions, 1e3 * e.decision_cpu_s / std::max(e.decisions, 1));
  for (const auto& [reason, length_m] : e.left_m) std::printf(" %.1f m %s;", length_m, reason.c_str());
  std::printf("\n");
  print_moments("contact", e.contacts);
  if (options.with_moments) print_moments("       ", e.moments);
}

int run(const Options& options) {
  std::ofstream paths = begin_paths(options.paths_file);
  bool are_complete = true;
  for (const std::string& scene : options.scenes) {
    for (const int seed : options.seeds) {
      for (const std::string& method : options.methods) {
        std::printf("%-13s %3d %-8s | ", scene.c_str(), seed, method.c_str());
        try {
          const ExplorationSetting setting = setting_of(options, scene, seed, method);
          const Exploration exploration = explore(simulator::open_world(setting.simulated), setting);
          print(exploration, options);
          std::string of = scene;
          of.append(",").append(method).append(",").append(std::to_string(seed));
          write_paths(exploration, of, paths);
        } catch (const std::exception& error) {
          std::printf("failed: %s\n", error.what());
          are_complete = false;
        }
        std::fflush(stdout);
      }
    }
  }
  return are_complete ? 0 : 1;
}

constexpr const char* kHelp =
    R"(Explorations of any building at true poses, with true depth and labels of 320 x 180 pixels five times a second: map,
planner and controller are the real ones. A row per run. What is left: frontiers of the last decision by why they were
not judged, a frontier with several viewpoints counts for each. Methods that need a pose graph decide without one.)";

}  // namespace
}  // namespace lapis::planner::benchmark

int main(int argc, char** argv) {
  using lapis::planner::benchmark::Options;
  CLI::App app(lapis::planner::benchmark::kHelp);
  Options options;
  app.add_option("--scenes", options.scenes, "bundled names, generated buildings, or files")->delimiter(',');
  app.add_option("--methods", options.methods, "of the planner")->delimiter(',');
  app.add_option("--seeds", options.seeds, "a run each")->delimiter(',');
  app.add_option("--duration", options.longest_s, "simulated time, at most [s]")->check(CLI::PositiveNumber);
  app.add_option("--set", options.overrides,
                 "planner.KEY=VALUE, controller.KEY=VALUE, robot.KEY=VALUE, simulator.KEY=VALUE");
  app.add_flag("--moments", options.with_moments, "also a row for each second");
  app.add_option("--paths", options.paths_file,
                 "a CSV file: what each path promised, and what it gave (launch_scripts/promise_table.py)");
  app.add_option("--known", options.known_places,
                 "places that are driven to at the end, through what is known by then, and back, twice")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return lapis::planner::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
