#include "supervisor/command_line.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

#include "common/runtime/version.hpp"
#include "supervisor/program.hpp"
#include "supervisor/supervisor.hpp"
#include "supervisor/system_yaml.hpp"

namespace lapis::supervisor {
namespace {

constexpr int kFailedRunning = 1;
constexpr int kBadSetup = 2;
constexpr const char* kSummary =
    "Runs a system of processes: starts them, watches their heartbeats, restarts or ends them, and leaves a run "
    "folder.\n"
    "launch_scripts/explore.sh and replay.sh call it.";

void add_options(CLI::App& app, std::string& system, Request& request, Settings& settings, Settings& facts) {
  const auto add_pair = [](Settings& pairs) {
    return [&pairs](const std::vector<std::string>& texts) {
      for (const auto& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0) throw CLI::ValidationError(text, "wanted is KEY=VALUE");
        pairs.push_back({text.substr(0, equals), text.substr(equals + 1)});
      }
      return true;
    };
  };
  app.add_option("system", system, "description of the system (config/systems/*.yaml)")->required();
  app.add_option("--out", request.out, "run folder")->required();
  app.add_option("--variant", request.variants, "variant of the system, such as freerun (repeatable)");
  app.add_flag("--restart", request.may_restart, "a process that dies or hangs is started again");
  app.add_option("--config", request.configuration, "YAML file, for the processes that know its sections (repeatable)");
  app.add_option("--set", add_pair(settings), "configuration KEY=VALUE, for the processes that know KEY (repeatable)")
      ->type_name("KEY=VALUE");
  app.add_option("--fact", add_pair(facts), "NAME=VALUE for manifest.yaml and metrics.json (repeatable)")
      ->type_name("NAME=VALUE");
  app.add_option("--command", request.command, "what the user called, for messages and manifest.yaml");
  app.add_option("--programs", request.programs, "folder of the programs; default: that of this one");
  app.set_version_flag("--version", std::string("lapis ") + kVersion);
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App app(kSummary, "lapis_supervisor");
  std::string system;
  Request request;
  Settings facts;
  request.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  request.command = "lapis_supervisor";
  add_options(app, system, request, request.settings, facts);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadSetup;
  }
  for (const auto& fact : facts) request.facts[fact.key] = fact.value;
  const std::string title = request.command.substr(0, request.command.find(' '));
  int failure = kBadSetup;
  try {
    block_signals();
    Supervisor supervisor(read_system(system), request);
    failure = kFailedRunning;
    return supervisor.run();
  } catch (const std::exception& error) {
    std::cerr << title << ": " << error.what() << '\n';
    return failure;
  }
}

}  // namespace lapis::supervisor
