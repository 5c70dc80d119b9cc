#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/domain.hpp"
#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

struct TopicsOptions {
  bool is_verbose = false;
  bool has_services = false;
  bool has_names_only = false;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

cdr::Value to_value(const SeenEndpoint& endpoint) {
  return {{"node", endpoint.node},
          {"type", endpoint.type},
          {"reliability", endpoint.is_reliable ? "reliable" : "best_effort"},
          {"durability", endpoint.is_latched ? "transient_local" : "volatile"},
          {"keyed", endpoint.is_keyed},
          {"type_hash", endpoint.type_hash}};
}

cdr::Value to_value(const SeenTopic& topic, bool is_verbose) {
  cdr::Value value{{"topic", topic.name},
                   {"types", topic.types},
                   {"writers", topic.writers.size()},
                   {"readers", topic.readers.size()}};
  if (!is_verbose) return value;
  for (const auto& [key, endpoints] : {std::pair{"publishers", &topic.writers}, {"subscribers", &topic.readers}}) {
    value[key] = cdr::Value::array();
    for (const SeenEndpoint& endpoint : *endpoints) value[key].push_back(to_value(endpoint));
  }
  return value;
}

void print_endpoint(const SeenEndpoint& endpoint) {
  std::cout << (endpoint.is_writer ? "  writer " : "  reader ") << (endpoint.node.empty() ? "?" : endpoint.node) << ", "
            << (endpoint.is_reliable ? "reliable" : "best effort") << ", "
            << (endpoint.is_latched ? "transient local" : "volatile") << (endpoint.is_keyed ? ", keyed" : "")
            << (endpoint.type_hash.empty() ? ", no type hash" : ", " + endpoint.type_hash) << '\n';
}

void print_topics(const Domain& domain, const TopicsOptions& options, bool is_json) {
  std::size_t width = 0;
  const std::vector<SeenTopic> topics = topics_of(domain.seen());
  for (const SeenTopic& topic : topics) width = std::max(width, topic.name.size());
  for (const SeenTopic& topic : topics) {
    if (options.has_names_only) {
      std::cout << topic.name << '\n';
    } else if (is_json) {
      std::cout << cdr::to_json(to_value(topic, options.is_verbose)) << '\n';
    } else {
      std::cout << topic.name << std::string(width - topic.name.size() + 2, ' ') << topic.writers.size()
                << " writer(s), " << topic.readers.size() << " reader(s)  " << joined(topic.types) << '\n';
      if (!options.is_verbose) continue;
      for (const auto* endpoints : {&topic.writers, &topic.readers}) {
        for (const SeenEndpoint& endpoint : *endpoints) print_endpoint(endpoint);
      }
    }
  }
}

void print_services(const Domain& domain, const TopicsOptions& options, bool is_json) {
  for (const SeenService& service : domain.services()) {
    if (options.has_names_only) {
      std::cout << service.name << '\n';
    } else if (is_json) {
      std::cout << cdr::to_json({{"service", service.name}, {"type", service.type()}, {"node", service.node}}) << '\n';
    } else {
      std::cout << service.name << "  " << service.type() << "  " << service.node << '\n';
    }
  }
}

Status list(const Settings& settings, const TopicsOptions& options) {
  Domain domain(settings);
  domain.settle();
  options.has_services ? print_services(domain, options, settings.is_json)
                       : print_topics(domain, options, settings.is_json);
  if (domain.participants() > 0 || domain.is_interrupted()) return kDone;
  throw Failure(kNotThere, "nothing is in the domain; lapis doctor says what to look at");
}

}  // namespace

void add_topics(CLI::App& app, const Settings& settings, Job& job) {
  auto options = std::make_shared<TopicsOptions>();
  CLI::App* command = app.add_subcommand("topics", "list the topics with their types, writers and readers");
  command->add_flag("-v,--verbose", options->is_verbose, "nodes, QoS and type hashes of all writers and readers, too");
  command->add_flag("--services", options->has_services, "list the services instead");
  command->add_flag("--names", options->has_names_only, "print names alone");
  command->callback([&settings, &job, options] { job = [&settings, options] { return list(settings, *options); }; });
}

}  // namespace lapis::command_line
