#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/core/parameters.hpp"
#include "command_line/service_call.hpp"
#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

using cdr::Value;

struct ParamsOptions {
  std::string node;
  std::vector<std::string> names;
};

/// The parameter services of one node.
class Node {
 public:
  Node(Domain& domain, const std::string& name) : domain_(domain), name_(domain.full_name(name)) {}

  Value list() { return ask("list_parameters", {})["result"]["names"]; }
  Value get(const Value& names) { return of_each(names, ask("get_parameters", {{"names", names}})["values"]); }
  Value describe(const Value& names) {
    return of_each(names, ask("describe_parameters", {{"names", names}})["descriptors"]);
  }
  Value set(const std::string& name, const Value& value) {
    const Value parameters = Value::array({{{"name", name}, {"value", value}}});
    return of_each(Value::array({name}), ask("set_parameters", {{"parameters", parameters}})["results"])[0];
  }
  const std::string& name() const { return name_; }

 private:
  Value ask(const std::string& service, const Value& request) {
    try {
      return call(domain_, name_ + "/" + service, request);
    } catch (const Failure& failure) {
      if (failure.status() != kNotThere) throw;
      throw Failure(kNotThere, not_among("node with parameters", name_, nodes_with_parameters()));
    }
  }
  std::vector<std::string> nodes_with_parameters() const {
    constexpr std::string_view kService = "/get_parameters";
    std::vector<std::string> nodes;
    for (const SeenService& service : domain_.services()) {
      if (!service.name.ends_with(kService)) continue;
      nodes.push_back(service.name.substr(0, service.name.size() - kService.size()));
    }
    return nodes;
  }
  /// ROS 2 answers with fewer elements when it does not know a name.
  Value of_each(const Value& names, Value answers) const {
    if (answers.size() == names.size()) return answers;
    throw Failure(kRefused, name_ + " does not know all of " + cdr::to_json(names) + "; lapis params list " + name_);
  }

  Domain& domain_;
  std::string name_;
};

void print_value(const Value& value, bool is_json) {
  std::cout << (is_json ? cdr::to_json(value) + "\n" : cdr::to_yaml(value, value.max_size()));
}

Status list_parameters(Node& node, const ParamsOptions& /*options*/, bool is_json) {
  const Value names = node.list();
  if (is_json) print_value(names, true);
  for (const Value& name : is_json ? Value::array() : names) std::cout << name.get<std::string>() << '\n';
  return kDone;
}

Value contents(Node& node, const Value& names) {
  const Value values = node.get(names);
  Value found = Value::object();
  for (std::size_t i = 0; i < names.size(); ++i) found[names[i].get<std::string>()] = content_of(values[i]);
  return found;
}

Status get_parameters(Node& node, const ParamsOptions& options, bool is_json) {
  const Value found = contents(node, options.names);
  const bool is_one = options.names.size() == 1 && !is_json;
  print_value(is_one ? found.front() : found, is_json);
  for (const auto& [name, value] : found.items()) {
    if (value.is_null()) throw Failure(kRefused, node.name() + " has no parameter " + name);
  }
  return kDone;
}

Status describe_parameters(Node& node, const ParamsOptions& options, bool is_json) {
  const Value names = options.names.empty() ? node.list() : Value(options.names);
  for (Value descriptor : node.describe(names)) {
    descriptor["type"] = type_name(descriptor["type"].get<int>());
    print_value(descriptor, is_json);
    if (!is_json) std::cout << "---\n";
  }
  return kDone;
}

Status dump_parameters(Node& node, const ParamsOptions& /*options*/, bool is_json) {
  print_value({{node.name(), {{"ros__parameters", as_tree(contents(node, node.list()))}}}}, is_json);
  return kDone;
}

Status set_parameter(Node& node, const ParamsOptions& options, bool is_json) {
  const std::string& name = options.names.at(0);
  const Value now = node.get(Value::array({name}))[0];
  Value value;
  try {
    value = to_parameter_value(options.names.at(1), now["type"].get<int>());
  } catch (const std::runtime_error& error) {
    throw Failure(kWrongCall, name + ": " + error.what());
  }
  const Value result = node.set(name, value);
  print_value(result, is_json);
  return is_success(result) ? kDone : kRefused;
}

using Action = Status (*)(Node&, const ParamsOptions&, bool);

void add_action(CLI::App& params, const Settings& settings, Job& job, const std::string& name,
                const std::string& meaning, Action action, int least_names, int most_names) {
  auto options = std::make_shared<ParamsOptions>();
  CLI::App* command = params.add_subcommand(name, meaning);
  command->add_option("node", options->node, "/slam")->required();
  if (most_names > 0) {
    const bool is_set = action == set_parameter;
    command->add_option(is_set ? "name and value" : "names", options->names, is_set ? "NAME VALUE" : "of parameters")
        ->expected(least_names, most_names)
        ->required(least_names > 0);
  }
  command->callback([&settings, &job, options, action] {
    job = [&settings, options, action] {
      Domain domain(settings);
      Node node(domain, options->node);
      return action(node, *options, settings.is_json);
    };
  });
}

}  // namespace

void add_params(CLI::App& app, const Settings& settings, Job& job) {
  constexpr int kAny = 1 << 20;
  CLI::App* params = app.add_subcommand("params", "list, read, describe and change the parameters of a node");
  params->require_subcommand(1);
  add_action(*params, settings, job, "list", "print the names", list_parameters, 0, 0);
  add_action(*params, settings, job, "get", "print values", get_parameters, 1, kAny);
  add_action(*params, settings, job, "set", "change one: NODE NAME VALUE", set_parameter, 2, 2);
  add_action(*params, settings, job, "describe", "print types, ranges and meanings; of all without names",
             describe_parameters, 0, kAny);
  add_action(*params, settings, job, "dump", "print all values as a YAML file of parameters", dump_parameters, 0, 0);
}

}  // namespace lapis::command_line
