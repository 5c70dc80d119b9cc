#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/service_call.hpp"
#include "common/cdr/text.hpp"
#include "common/topics/services.hpp"

namespace lapis::command_line {
namespace {

struct CallOptions {
  std::string service;
  std::string request;
};

Status print_answer(const cdr::Value& response, bool is_json) {
  std::cout << (is_json ? cdr::to_json(response) + "\n" : cdr::to_yaml(response));
  return is_success(response) ? kDone : kRefused;
}

Status call_any(const Settings& settings, const CallOptions& options) {
  const cdr::Value request = cdr::from_yaml(options.request);
  Domain domain(settings);
  return print_answer(call(domain, domain.full_name(options.service), request), settings.is_json);
}

Status call_trigger(const Settings& settings, const dds::ServiceTopic<std_srvs::srv::Trigger>& service) {
  Domain domain(settings);
  return print_answer(call(domain, dds::full_name(service, domain.names()), {}), settings.is_json);
}

}  // namespace

void add_calls(CLI::App& app, const Settings& settings, Job& job) {
  auto options = std::make_shared<CallOptions>();
  CLI::App* command = app.add_subcommand("call", "call a service and print its answer");
  command->add_option("service", options->service, "/planner/pause")->required();
  command->add_option("request", options->request, "YAML or JSON: '{data: true}'; fields left out are zero or empty");
  command->callback(
      [&settings, &job, options] { job = [&settings, options] { return call_any(settings, *options); }; });
  const auto add = [&](const std::string& name, const std::string& meaning, const auto& service) {
    app.add_subcommand(name, meaning)->callback([&settings, &job, &service] {
      job = [&settings, &service] { return call_trigger(settings, service); };
    });
  };
  add("pause", "stand still until resumed: calls /planner/pause", topics::kPauseExploring);
  add("resume", "explore on, also after the end: calls /planner/start", topics::kStartExploring);
  add("home", "drive to where exploration began: calls /planner/return_home", topics::kReturnHome);
  add("save", "write the map's files now: calls /semantic_mapper/save", topics::kSaveMap);
}

}  // namespace lapis::command_line
