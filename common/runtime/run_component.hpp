#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/config/schema.hpp"
#include "common/runtime/component_main.hpp"
#include "common/runtime/context.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls itself so
class App;
}

namespace lapis::runtime {

/// The keys of every process under `dds.`.
struct DdsConfig {
  int socket_buffer_bytes = 4 << 20;
  std::string sensor_qos = "auto";
  std::string color_transport = "raw";
  std::string depth_transport = "raw";
  config::Words remap;
};

template <class Field>
void describe(Field& field, DdsConfig& c) {
  field("socket_buffer_bytes", c.socket_buffer_bytes, config::in_range(65536, 1 << 30),
        "size requested for the send buffer and the receive buffer of each UDP socket [B]");
  field("sensor_qos", c.sensor_qos, config::one_of({"auto", "reliable", "best_effort"}),
        "how topics of sensors are read and written; auto: reliable, and read by best effort once a writer offers no "
        "more; lock-step needs reliable");
  field("color_transport", c.color_transport, config::one_of({"raw", "compressed"}),
        "which topic of the colour images is read; compressed: /camera/color/image_raw/compressed");
  field("depth_transport", c.depth_transport, config::one_of({"raw", "compressed"}),
        "which topic of the depth images is read; compressed: /camera/depth/image_raw/compressedDepth");
  field("remap", c.remap, config::anything(),
        "other names of topics, services and frames, as from:=to; --remap adds to the list");
}

/// The keys of every process under `log.`.
struct LogConfig {
  std::string level = "info";
};

template <class Field>
void describe(Field& field, LogConfig& c) {
  field("level", c.level, config::one_of({"debug", "info", "warn", "error"}),
        "lowest level of messages that are logged, to standard error and /rosout", config::Change::kAtRunTime);
}

/// A component as run() sees it.
struct ComponentFactory {
  std::string name;
  std::string summary;
  config::Schema schema;  ///< without `dds.` and `log.`
  /// Adds the component's own options and positional arguments.
  std::function<void(CLI::App&)> add_options;
  /// Conditions between its keys.
  std::function<config::Rules()> rules;
  /// Runs a job that needs no DDS (such as --list) and returns its exit status; nothing: the component runs.
  std::function<std::optional<int>()> run_tool;
  /// A component that has been built.
  struct Running {
    std::function<void()> finish;       ///< owns it; called at the end, once spinning has stopped
    std::function<void()> reconfigure;  ///< values of its keys have changed; empty: none may
  };
  std::function<Running(Context&)> create;
};

/// Runs a process: command line, configuration, DDS, signals, spinning. Returns the exit status (0 finished or asked to
/// stop, 1 failed while running, 2 bad set-up).
int run(ComponentFactory factory, int argc, char** argv);

/// `Component` has: `Config` (described for common/config), `kName`, `kSummary`, a constructor (const Config&,
/// Context&), and, where needed, `static void add_options(CLI::App&, Config&)`, `static config::Rules rules(const
/// Config&)`, `static std::optional<int> run_tool(const Config&)`, `void finish()`, called when spinning has stopped,
/// and `void reconfigure(const Config&)`, called between cycles when keys that may change at run time have changed. The
/// configurations that it gets are within their bounds, and the rules hold.
template <class Component>
int run_component(int argc, char** argv) {
  using Config = typename Component::Config;
  Config config;
  ComponentFactory factory;
  factory.name = Component::kName;
  factory.summary = Component::kSummary;
  factory.schema(Component::kName, config);
  if constexpr (requires { &Config::robot; }) factory.schema("robot", config.robot);
  if constexpr (requires { &Config::lockstep; }) factory.schema("lockstep", config.lockstep);
  if constexpr (requires(CLI::App & app) { Component::add_options(app, config); }) {
    factory.add_options = [&config](CLI::App& app) { Component::add_options(app, config); };
  }
  if constexpr (requires { Component::rules(config); }) {
    factory.rules = [&config] { return Component::rules(config); };
  }
  if constexpr (requires { Component::run_tool(config); }) {
    factory.run_tool = [&config] { return Component::run_tool(config); };
  }
  factory.create = [&config](Context& context) {
    auto component = std::make_shared<Component>(config, context);
    ComponentFactory::Running running;
    running.finish = [component] {
      if constexpr (requires { component->finish(); }) component->finish();
    };
    if constexpr (requires { component->reconfigure(config); }) {
      running.reconfigure = [&config, component] { component->reconfigure(config); };
    }
    return running;
  };
  return run(std::move(factory), argc, argv);
}

}  // namespace lapis::runtime
