#include "command_line/command_line.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

#include "command_line/commands.hpp"
#include "common/dds/discovery.hpp"
#include "common/runtime/version.hpp"

namespace lapis::command_line {
namespace {

constexpr const char* kSummary =
    "Looks at the topics and services of a DDS domain, calls, steers, records and checks them, without ROS.";
constexpr const char* kFooter =
    "Exit status: 0 done, 1 refused or something found, 2 wrong call, 3 not in the domain, 4 no message or answer in\n"
    "time. ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS mean what they mean in ROS 2.";

void add_common_options(CLI::App& app, Settings& settings) {
  app.add_option("--domain", settings.domain, "DDS domain; default: ROS_DOMAIN_ID, or 0 if it is not set")
      ->check(CLI::Range(0, dds::kLargestDomain));
  app.add_option("--namespace", settings.name_space, "robot name that is put before names without leading slash");
  app.add_option("--remap", settings.remaps,
                 "another name for a topic or service of docs/topics.md: from:=to, without the namespace (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--wait", settings.wait_s, "longest time to look for what is asked for, and for its answer [s]")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--socket-buffer", settings.socket_buffer_bytes, "size requested for each UDP socket [B]")
      ->check(CLI::Range(65536, 1 << 30))
      ->capture_default_str();
  app.add_flag("--json", settings.is_json, "print JSON, one value a line");
  app.set_version_flag("--version", std::string("lapis ") + kVersion);
}

Status execute(const Job& job) {
  try {
    return job();
  } catch (const Failure& failure) {
    std::cerr << "lapis: " << failure.what() << '\n';
    return failure.status();
  } catch (const std::exception& error) {
    std::cerr << "lapis: " << error.what() << '\n';
    return kWrongCall;
  }
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App app(kSummary, "lapis");
  app.footer(kFooter);
  app.fallthrough();  // the common options may follow the command
  app.require_subcommand(1);
  Settings settings;
  Job job;
  add_common_options(app, settings);
  for (const auto& add : {add_topics, add_rates, add_echo, add_calls, add_goal, add_params, add_record, add_doctor}) {
    add(app, settings, job);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kWrongCall;
  }
  return execute(job);
}

}  // namespace lapis::command_line
