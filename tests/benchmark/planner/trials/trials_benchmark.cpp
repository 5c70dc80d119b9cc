// Missions without images, controller and DDS, a row each.
//   lapis_planner_trials --errors errors.csv --scenes flat_40,ring_40 --methods mi_only:nearest,expected:expected
//   --rows trials.csv
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/yaml.hpp"
#include "planner/core/methods/expected.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/planner/trials/trial.hpp"

namespace lapis::planner::benchmark {
namespace {

struct Options {
  std::string errors_file, rows_file, gains_file;
  std::vector<std::string> scenes, methods{"mi_only:nearest", "expected:expected"}, overrides;
  std::vector<int> seeds{1};
  double longest_s = 300.0;
};

constexpr const char* kHeader =
    "scene,seed,method,explored,t90_s,done_s,path_m,ate_se3_m,ate_raw_m,surviving,predicted,keyframes,loops,decisions,"
    "revisits,"
    "decision_ms,cpu_s";

constexpr const char* kGainsHeader =
    "scene,seed,method,time_s,kind,path_m,loops,map_nats,promised_nats,by_graph_nats,true_nats";

constexpr const char* kExpected = "expected";

/// `method`: METHOD or METHOD:THEN, names of the planner's methods or `expected`.
TrialSetting setting_of(const Options& options, const std::string& scene, int seed, const std::string& method) {
  TrialSetting setting;
  setting.longest_s = options.longest_s;
  setting.with_gains = !options.gains_file.empty();
  robot::RobotDescription robot;
  robot.camera.width = 320;
  robot.camera.height = 180;
  config::Schema schema;
  schema("simulator", setting.simulated);
  schema("robot", robot);
  schema("planner", setting.planner);
  for (const std::string& assignment : options.overrides) config::apply_override(schema, assignment);
  const auto colon = method.find(':');
  const std::string first = method.substr(0, colon), then = colon == std::string::npos ? "" : method.substr(colon + 1);
  if (first != kExpected) config::apply_override(schema, "planner.method=" + first);
  if (!then.empty()) config::apply_override(schema, "planner.then=" + (then == kExpected ? "nearest" : then));
  config::check(schema);
  setting.simulated.scene = scene;
  setting.simulated.seed = seed;
  setting.simulated.robot = setting.planner.robot = robot;
  setting.planner = completed(setting.planner);
  if (first == kExpected) setting.planner.decision.method = std::make_shared<Expected>();
  if (then == kExpected) setting.planner.consolidation = std::make_shared<ExpectedAmongOldPlaces>();
  return setting;
}

void write_gains(std::ostream& out, const std::string& key, const std::vector<Gain>& gains) {
  for (const Gain& gain : gains) {
    char text[256];
    std::snprintf(text, sizeof text, "%s,%.2f,%s,%.2f,%d,%.1f,%.2f,%.2f,%.2f", key.c_str(), gain.time_s,
                  gain.is_revisit ? "revisit" : "other", gain.path_m, gain.loops, gain.map_nats, gain.promised_nats,
                  gain.by_graph_nats, gain.true_nats);
    out << text << '\n';
  }
  out.flush();
}

/// Opened before the first mission, so that a file that cannot be written is known before an hour of missions.
std::ofstream open_gains(const std::string& file) {
  std::ofstream out;
  if (file.empty()) return out;
  out.open(file, std::ios::app);
  if (out.tellp() == 0) out << kGainsHeader << std::endl;
  if (!out) throw std::runtime_error(file + " cannot be written");
  return out;
}

int run(const Options& options) {
  const ErrorModel errors = ErrorModel::read(options.errors_file);
  std::set<std::string> done;
  std::ifstream known(options.rows_file);
  for (std::string line; std::getline(known, line);) {
    std::size_t end = 0;
    for (int i = 0; i < 3; ++i) end = line.find(',', end + (i > 0 ? 1 : 0));
    done.insert(line.substr(0, end));
  }
  std::ofstream rows(options.rows_file, std::ios::app);
  if (done.empty()) rows << kHeader << std::endl;
  if (!rows) throw std::runtime_error(options.rows_file + " cannot be written");
  std::ofstream gains = open_gains(options.gains_file);
  std::printf("%s\n", kHeader);
  bool are_complete = true;
  for (const std::string& scene : options.scenes) {
    for (const int seed : options.seeds) {
      for (const std::string& method : options.methods) {
        std::string key = scene;
        for (const std::string& cell : {std::to_string(seed), method}) key.append(",").append(cell);
        if (done.contains(key)) continue;
        try {
          const TrialSetting setting = setting_of(options, scene, seed, method);
          const TrialResult r = run_trial(simulator::open_world(setting.simulated), setting, errors);
          char text[256];
          std::snprintf(text, sizeof text, "%s,%.4f,%.0f,%.0f,%.1f,%.4f,%.4f,%.4f,%.4f,%d,%d,%d,%d,%.1f,%.1f",
                        key.c_str(), r.explored_share, r.time_to_90_s, r.done_s, r.path_m, r.ate_se3_m, r.ate_raw_m,
                        r.surviving_share, r.predicted_share, r.keyframes, r.loops, r.decisions, r.revisits,
                        1e3 * r.decision_cpu_s / std::max(r.decisions, 1), r.cpu_s);
          if (setting.with_gains) write_gains(gains, key, r.gains);
          if (!gains) throw std::runtime_error(options.gains_file + " cannot be written");
          if (!(rows << text << std::endl)) throw std::runtime_error(options.rows_file + " cannot be written");
          std::printf("%s\n", text);
        } catch (const std::exception& error) {
          std::fprintf(stderr, "%s: %s\n", key.c_str(), error.what());
          are_complete = false;
        }
        std::fflush(stdout);
      }
    }
  }
  return are_complete ? 0 : 1;
}

constexpr const char* kHelp =
    R"(Missions by the real planner and the real map, without images, controller and DDS. Depth is cast by rays, the robot
follows its path, and slam is drawn from recorded errors of edges (lapis_surviving_share --edges): key-frames, loops, and
an optimised graph that moves the map. A row per mission; those in the file of rows are not repeated.)";

}  // namespace
}  // namespace lapis::planner::benchmark

int main(int argc, char** argv) {
  using lapis::planner::benchmark::Options;
  CLI::App app(lapis::planner::benchmark::kHelp);
  Options options;
  app.add_option("--errors", options.errors_file, "CSV file of recorded edges")->required();
  app.add_option("--rows", options.rows_file, "CSV file to add the rows to")->required();
  app.add_option("--gains", options.gains_file,
                 "CSV file to add a line for each decision to: what it promised to secure of the map, and what came");
  app.add_option("--scenes", options.scenes, "bundled names, generated buildings, or files")
      ->delimiter(',')
      ->required();
  app.add_option(
         "--methods", options.methods,
         "METHOD, or METHOD:THEN with what is done when nothing is left to explore; names of the planner's methods, "
         "or expected (expected map information)")
      ->delimiter(',');
  app.add_option("--seeds", options.seeds, "a mission each")->delimiter(',');
  app.add_option("--duration", options.longest_s, "simulated time of a mission [s]")->check(CLI::PositiveNumber);
  app.add_option("--set", options.overrides, "planner.KEY=VALUE, robot.KEY=VALUE, simulator.KEY=VALUE");
  CLI11_PARSE(app, argc, argv);
  try {
    return lapis::planner::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
