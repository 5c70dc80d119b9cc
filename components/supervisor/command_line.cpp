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

/// Parses the "KEY=VALUE" of an option.
Setting to_setting(const std::string& option, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw CLI::ValidationError(option + " " + text, "unknown key; wanted is KEY=VALUE");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

struct Options {
  std::string system;
  std::vector<std::string> settings;
  std::vector<std::string> facts;
};

void add_options(CLI::App& app, Options& options, Request& request) {
  app.add_option("system", options.system, "YAML file that describes the system (config/systems/*.yaml)")->required();
  app.add_option("--out", request.out, "run folder, into which the run writes its files")->required();
  app.add_option("--variant", request.variants, "variant of the system to run, such as freerun (repeatable)");
  app.add_flag("--restart", request.may_restart, "restart processes that die or hang, except the source of the data");
  app.add_option("--config", request.configuration,
                 "YAML configuration file, which the processes that know its sections read (repeatable)");
  app.add_option("--set", options.settings, "KEY=VALUE, a setting for the processes that know KEY (repeatable)");
  app.add_option("--fact", options.facts,
                 "NAME=VALUE, a text that is written to manifest.yaml and metrics.json (repeatable)");
  app.add_option("--command", request.command, "command that the user called, for messages and manifest.yaml");
  app.add_option("--programs", request.programs, "folder of the programs lapis_*; default: that of lapis_supervisor");
  for (const char* repeatable : {"--variant", "--config", "--set", "--fact"}) {
    app.get_option(repeatable)->allow_extra_args(false);
  }
  app.set_version_flag("--version", std::string("lapis ") + kVersion);
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App app(kSummary, "lapis_supervisor");
  Options options;
  Request request;
  request.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  request.command = "lapis_supervisor";
  add_options(app, options, request);
  try {
    app.parse(argc, argv);
    for (const auto& text : options.settings) request.settings.push_back(to_setting("--set", text));
    for (const auto& text : options.facts) {
      const auto [name, value] = to_setting("--fact", text);
      request.facts[name] = value;
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadSetup;
  }
  const std::string title = request.command.substr(0, request.command.find(' '));
  int failure = kBadSetup;
  try {
    block_signals();
    Supervisor supervisor(read_system(options.system), request);
    failure = kFailedRunning;
    return supervisor.run();
  } catch (const std::exception& error) {
    std::cerr << title << ": " << error.what() << '\n';
    return failure;
  }
}

}  // namespace lapis::supervisor
