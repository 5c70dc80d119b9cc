#include "common/runtime/run_component.hpp"

#include <CLI/CLI.hpp>

#include <pthread.h>
#include <semaphore.h>

#include <atomic>
#include <csignal>
#include <iostream>
#include <thread>

#include "common/config/yaml.hpp"
#include "common/dds/host_addresses.hpp"
#include "common/dds/participant.hpp"
#include "common/logging/line_queue.hpp"
#include "common/runtime/known_names.hpp"
#include "common/runtime/node_services.hpp"
#include "common/runtime/rosout.hpp"
#include "common/runtime/version.hpp"

namespace lapis::runtime {
namespace {

constexpr int kAskedToStop = 0;
constexpr int kFailedRunning = 1;
constexpr int kBadSetup = 2;
constexpr int kSmallSocketBuffer = 1 << 20;

struct Arguments {
  std::vector<std::string> config_files;
  std::vector<std::string> overrides;
  std::vector<std::string> remaps;
  std::optional<int> domain;
  std::string name_space;
  std::string transport = "udp";
  bool use_sim_time = false;
  bool print_config = false;
  bool print_config_table = false;
  bool check_config = false;
};

void add_common_options(CLI::App& app, Arguments& arguments, LogConfig& log) {
  app.add_option("--config", arguments.config_files,
                 "YAML configuration file; later files override earlier ones (repeatable)");
  app.add_option("--set", arguments.overrides, "set one configuration value: path=value; overrides files (repeatable)");
  app.add_option(
      "--remap", arguments.remaps,
      "another name for a topic, service or frame of docs/topics.md: from:=to, without the namespace; adds to "
      "dds.remap (repeatable)");
  app.add_option("--domain", arguments.domain, "DDS domain; default: ROS_DOMAIN_ID, or 0 if it is not set")
      ->check(CLI::Range(0, dds::kLargestDomain));
  app.add_option("--namespace", arguments.name_space, "robot name that prefixes topics and frames");
  app.add_option("--transport", arguments.transport,
                 "DDS transport: udp, or shm (shared memory) on hosts without ROS 2 processes")
      ->check(CLI::IsMember({"udp", "shm"}));
  app.add_option("--log-level", log.level, "log.level: debug, info, warn or error")
      ->check(CLI::IsMember({"debug", "info", "warn", "error"}));
  app.add_flag("--use-sim-time", arguments.use_sim_time, "take the time from /clock instead of the system's clock");
  app.add_flag("--print-config", arguments.print_config, "print the configuration in effect and exit");
  app.add_flag("--print-config-table", arguments.print_config_table,
               "print the configuration in effect as a table for the component's page and exit");
  app.add_flag("--check-config", arguments.check_config,
               "check the configuration, but not the files that it names, and exit");
  app.set_version_flag("--version", std::string("lapis ") + kVersion);
}

dds::SensorQos sensor_qos(const std::string& word) {
  if (word == "auto") return dds::SensorQos::kAuto;
  return word == "reliable" ? dds::SensorQos::kReliable : dds::SensorQos::kBestEffort;
}

ContextOptions context_options(const std::string& name, const Arguments& arguments, const DdsConfig& dds) {
  ContextOptions options;
  options.name = name;
  options.use_sim_time = arguments.use_sim_time;
  options.participant.node_name = name;
  options.participant.names = {arguments.name_space, dds::parse_remaps(dds.remap, known_names())};
  options.participant.discovery = dds::discovery_from_environment();
  if (arguments.domain) options.participant.discovery.domain = *arguments.domain;
  options.participant.transport = arguments.transport == "shm" ? dds::Transport::kSharedMemory : dds::Transport::kUdp;
  options.participant.socket_buffer_bytes = dds.socket_buffer_bytes;
  options.participant.sensor_qos = sensor_qos(dds.sensor_qos);
  options.is_color_compressed = dds.color_transport == "compressed";
  options.is_depth_compressed = dds.depth_transport == "compressed";
  return options;
}

void log_setup(const config::Schema& schema, const ContextOptions& options) {
  for (const auto& entry : schema.entries()) spdlog::debug("{} = {}", entry.path, config::to_text(entry));
  const int granted = dds::effective_socket_buffer_bytes(options.participant.socket_buffer_bytes);
  spdlog::info("domain {}, socket buffers {} bytes", options.participant.discovery.domain, granted);
  if (granted < kSmallSocketBuffer) {
    spdlog::warn(
        "socket buffers below 1 MiB make images late: install /etc/sysctl.d/60-lapis.conf "
        "(launch_scripts/setup.sh --sysctl)");
  }
  for (const auto& [from, to] : options.participant.names.remapped) spdlog::info("{} is called {}", from, to);
  if (!dds::stays_on_host(options.participant.discovery) && !dds::has_network_interface()) {
    spdlog::warn("no network interface is up: other hosts will not find this process until it is started again");
  }
  if (options.participant.transport == dds::Transport::kSharedMemory) {
    spdlog::warn("shared memory: no ROS 2 process may run on this host (docs/decisions)");
  }
}

/// Ends the run on SIGINT or SIGTERM; a SIGINT, even one that comes later, also hurries the end. A signal handler
/// receives the signals in any thread: blocking them in our own threads does not keep them from threads that a library
/// such as OpenBLAS started before main(), where they would end the process.
class SignalWaiter {
 public:
  explicit SignalWaiter(Context& context) {
    thread_ = std::thread([this, &context] {
      pthread_sigmask(SIG_UNBLOCK, &signals(), nullptr);
      while (!is_over_) {
        if (sem_wait(&has_come) == 0 && !is_over_) context.stop(newest == SIGINT);
      }
    });
  }
  ~SignalWaiter() {
    is_over_ = true;
    sem_post(&has_come);  // ends the wait when no signal has arrived
    thread_.join();
  }
  SignalWaiter(const SignalWaiter&) = delete;
  SignalWaiter& operator=(const SignalWaiter&) = delete;

  /// From here on, signals wait for a SignalWaiter. New threads inherit the mask, so that signals do not interrupt
  /// their system calls.
  static void prepare() {
    sem_init(&has_come, 0, 0);
    std::signal(SIGINT, remember);
    std::signal(SIGTERM, remember);
    pthread_sigmask(SIG_BLOCK, &signals(), nullptr);
  }

 private:
  static void remember(int signal) {
    newest = signal;
    sem_post(&has_come);
  }
  static const sigset_t& signals() {
    static const sigset_t both = [] {
      sigset_t s;
      sigemptyset(&s);
      for (const int signal : {SIGINT, SIGTERM}) sigaddset(&s, signal);
      return s;
    }();
    return both;
  }

  static inline sem_t has_come;
  static inline std::atomic<int> newest{0};
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

int spin(const ComponentFactory& factory, Context& context, const std::function<void()>& finish) {
  try {
    const SignalWaiter waiter(context);
    context.run();
    finish();
    spdlog::info("stopped");
    return context.exit_status();
  } catch (const BadSetup& error) {
    context.fail(error.what());
    return kBadSetup;
  } catch (const std::exception& error) {
    context.fail(factory.name + " failed: " + error.what());
    return kFailedRunning;
  }
}

/// The keys as parameters of the node.
parameters::Parameters parameters_of(const ComponentFactory& factory, const ComponentFactory::Running& component,
                                     const LogConfig& log, bool& use_sim_time) {
  config::Schema schema = factory.schema;
  schema("use_sim_time", use_sim_time, config::anything(), "whether time is that of /clock: --use-sim-time");
  return {factory.name, std::move(schema), {factory.rules, [&log, reconfigure = component.reconfigure] {
                                              logging::set_level(log.level);
                                              if (reconfigure) reconfigure();
                                            }}};
}

int set_up_and_spin(const ComponentFactory& factory, const LogConfig& log, ContextOptions options) {
  SignalWaiter::prepare();        // before DDS starts its threads
  std::signal(SIGXFSZ, SIG_IGN);  // write() then reports a file size limit as an error, like a full disk
  const auto lines = std::make_shared<logging::LineQueue>();
  spdlog::default_logger()->sinks().push_back(lines);
  std::unique_ptr<Context> context;
  std::optional<Rosout> rosout;
  ComponentFactory::Running component;
  std::optional<NodeServices> services;
  try {
    log_setup(factory.schema, options);
    context = std::make_unique<Context>(options);
    rosout.emplace(context->participant(), context->participant().names().full("/" + factory.name), lines);
    component = factory.create(*context);
    services.emplace(*context, parameters_of(factory, component, log, options.use_sim_time));
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kBadSetup;
  }
  return spin(factory, *context, component.finish);
}

/// Does what the command line asks for instead of running the component, and returns the exit status; otherwise returns
/// nothing.
std::optional<int> answer(const ComponentFactory& factory, const Arguments& arguments) {
  if (arguments.print_config) {
    std::cout << config::to_yaml(factory.schema);
    return kAskedToStop;
  }
  if (arguments.print_config_table) {
    std::cout << config::to_markdown(factory.schema);
    return kAskedToStop;
  }
  if (arguments.check_config) return kAskedToStop;
  return factory.run_tool ? factory.run_tool() : std::nullopt;
}

}  // namespace

int run(ComponentFactory factory, int argc, char** argv) {
  CLI::App app(factory.summary, "lapis_" + factory.name);
  Arguments arguments;
  DdsConfig dds;
  LogConfig log;
  factory.schema("dds", dds);
  factory.schema("log", log);
  add_common_options(app, arguments, log);
  if (factory.add_options) factory.add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kAskedToStop : kBadSetup;
  }
  ContextOptions options;
  try {
    logging::set_up(factory.name, log.level);
    dds::check_namespace(arguments.name_space);
    for (const auto& file : arguments.config_files) config::apply_file(factory.schema, file);
    for (const auto& assignment : arguments.overrides) config::apply_override(factory.schema, assignment);
    app.parse(argc, argv);  // again, because the component's own options override files
    dds.remap.insert(dds.remap.end(), arguments.remaps.begin(), arguments.remaps.end());
    config::check(factory.schema);
    logging::set_level(log.level);
    if (factory.rules) config::check(factory.schema, factory.rules());
    options = context_options(factory.name, arguments, dds);
    if (const auto status = answer(factory, arguments)) return *status;
  } catch (const std::exception& error) {
    std::cerr << "lapis_" << factory.name << ": " << error.what() << '\n';
    return kBadSetup;
  }
  return set_up_and_spin(factory, log, options);
}

}  // namespace lapis::runtime
