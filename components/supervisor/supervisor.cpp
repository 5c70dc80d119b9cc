#include "supervisor/supervisor.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <random>
#include <sstream>

#include "common/config/schema.hpp"
#include "common/files/atomic_file.hpp"
#include "common/topics/heartbeat.hpp"

namespace lapis::supervisor {
namespace {

constexpr std::chrono::milliseconds kTurn(50);
constexpr double kAbsent_s = 1.0;          // a longer turn has missed heartbeats: the machine or this process stopped
constexpr double kHurriedSilence_s = 2.0;  // allowed silence in a hurry, for a process that announces none
constexpr double kHurry_s = 9.0;           // longest time from Ctrl-C to the end of all processes
constexpr double kInOrder_s = 4.0;         // part of it in which processes end one after the other; then all are asked
constexpr int kBadSetupStatus = 2;
constexpr const char* kManifest = "manifest.yaml";

const sigset_t& ending_signals() {
  static const sigset_t signals = [] {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    struct sigaction hangup {};  // SIGHUP is ignored under nohup, so that the run outlives its terminal
    sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) sigaddset(&set, SIGHUP);
    return set;
  }();
  return signals;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Gives the run an id, for this process and those that it starts, unless it has one already: processes on several
/// machines are given the same.
void name_run() {
  if (!dds::process_environment("LAPIS_RUN").value_or("").empty()) return;
  std::random_device random;
  std::ostringstream id;
  id << std::hex << std::setfill('0') << std::setw(8) << random() << std::setw(8) << random();
  setenv("LAPIS_RUN", id.str().c_str(), 1);  // NOLINT(concurrency-mt-unsafe): before threads start
}

dds::ParticipantOptions participant_options() {
  name_run();
  dds::ParticipantOptions options;
  options.node_name = "supervisor";
  options.discovery = dds::discovery_from_environment();
  return options;
}

std::string seconds_text(double seconds) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << seconds << " s";
  return out.str();
}

/// Replaces "{run_folder}" in the values of the description.
Settings with_run_folder(Settings settings, const std::filesystem::path& folder) {
  static const std::string place = "{run_folder}";
  for (auto& [key, value] : settings) {
    if (const auto at = value.find(place); at != std::string::npos) value.replace(at, place.size(), folder.string());
  }
  return settings;
}

void append(std::vector<std::string>& arguments, const Settings& settings) {
  for (const auto& [key, value] : settings) {
    arguments.emplace_back("--set");
    arguments.emplace_back(key).append("=").append(value);
  }
}

/// The system with the variants that were asked for, one after the other.
System as_asked(System system, const Request& request) {
  for (const auto& name : request.variants) {
    const auto variant = system.variants.find(name);
    if (variant == system.variants.end()) throw BadSetup("--variant " + name + ": " + system.name + " has none");
    system = varied(system, variant->second);
  }
  return system;
}

}  // namespace

void block_signals() {
  pthread_sigmask(SIG_BLOCK, &ending_signals(), nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // the reader of the output may end before the run: Ctrl-C ends all of `... | tee`
}

Supervisor::Supervisor(System system, Request request)
    : system_(as_asked(std::move(system), request)), request_(std::move(request)),
      title_(request_.command.substr(0, request_.command.find(' '))), folder_(request_.out),
      participant_(participant_options()),
      heartbeats_(participant_, topics::kHeartbeat, [this](const auto& heartbeat) { hear(heartbeat); }) {
  executor_.add(heartbeats_);
  for (const auto& name : system_.processes) processes_.emplace_back().name = name;
  settings_ = all_settings();
  const bool has_results = exists(folder_.path() / kManifest);
  if (!has_results) write_manifest();  // also for a run that is refused
  collect_arguments();
  usual_silence_s_ = usual_silence();
  if (has_results) clear_folder();  // only now, so that a refused run does not remove an earlier one
}

void Supervisor::clear_folder() const {
  std::vector<std::filesystem::path> kept;  // maps of an earlier run that this run resumes
  for (const auto& setting : settings_) kept.emplace_back(setting.value);
  folder_.clear(system_.results, kept);
}

/// All settings of the run; later ones win.
Settings Supervisor::all_settings() const {
  Settings settings = system_.settings;
  const auto add = [&](const Settings& more) { settings.insert(settings.end(), more.begin(), more.end()); };
  if (request_.may_restart) add(system_.restart.settings);
  add(request_.settings);
  return settings;
}

/// Configuration files, each with the processes that get it; later files win.
std::vector<std::pair<std::string, std::set<std::string>>> Supervisor::configuration_files(
    const Configurations& known) const {
  std::vector<std::pair<std::string, std::set<std::string>>> files;
  const auto add = [&](const std::string& file) {
    try {
      files.emplace_back(file, readers_of(known, sections_of(file)));
    } catch (const UnknownSetting& error) {
      throw BadSetup(file + ": " + error.what());
    }
  };
  for (const auto& file : system_.configuration) add(file);
  for (const auto& file : request_.configuration) add(file);
  return files;
}

/// Collects the arguments of each process from the keys that it knows. Every process that writes files gets the run
/// folder.
void Supervisor::collect_arguments() {
  const auto program = [&](const std::string& name) { return request_.programs / ("lapis_" + name); };
  Configurations known;
  for (const auto& process : processes_) known[process.name] = print_configuration(program(process.name), {}).values;
  const auto routed = route(known, settings_);
  const auto files = configuration_files(known);
  std::string stages;
  for (const auto& stage : system_.stages) stages += (stages.empty() ? "[" : ", ") + stage;
  for (auto& process : processes_) {
    const Configuration& keys = known.at(process.name);
    for (const auto& [file, readers] : files) {
      if (readers.contains(process.name)) process.arguments.insert(process.arguments.end(), {"--config", file});
    }
    const std::string out_key = process.name + ".output_dir";
    if (keys.contains(out_key)) append(process.arguments, {{out_key, folder_.path().string()}});
    if (!stages.empty() && keys.contains("lockstep.stages"))
      append(process.arguments, {{"lockstep.stages", stages + "]"}});
    const auto own = routed.find(process.name);
    if (own != routed.end()) append(process.arguments, own->second);
    process.configuration = print_configuration(program(process.name), process.arguments);
  }
}

/// Longest time without a heartbeat that needs no announcement [s]: a number, or the value of a key.
double Supervisor::usual_silence() const {
  const std::string& text = system_.silence;
  for (const auto& process : processes_) {
    const auto value = process.configuration.values.find(text);
    if (value != process.configuration.values.end()) return std::stod(value->second);
  }
  try {
    return std::stod(text);
  } catch (const std::exception&) {
    throw BadSetup(system_.name + ".yaml: silence_s: " + text + " is neither a number nor a key of a process");
  }
}

Facts Supervisor::facts() const {
  Facts facts = {{"system", config::quoted(system_.name)}};
  for (const auto& [name, key] : system_.facts) {
    for (const auto& setting : settings_) {  // nothing else is known of a run that is refused
      if (setting.key == key) facts[name] = config::quoted(setting.value);
    }
    for (const auto& process : processes_) {
      const auto value = process.configuration.values.find(key);
      if (value != process.configuration.values.end()) facts[name] = value->second;
    }
  }
  for (const auto& [name, text] : request_.facts) facts[name] = config::quoted(text);
  return facts;
}

double Supervisor::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int Supervisor::run() {
  turned_s_ = now_s();
  write_manifest();
  if (start_all()) wait_until_over();
  progress_.end();
  end_all();
  const int status = conclude();  // before the files, so that it is printed even when the disk is full
  write_manifest();
  add_facts_to_metrics();
  return status;
}

void Supervisor::start(Process& process, const Settings& more) {
  auto arguments = process.arguments;
  append(arguments, more);
  process.child =
      std::make_unique<Child>(request_.programs / ("lapis_" + process.name), arguments, folder_.log(process.name));
  process.pulse.emplace(now_s());
}

/// Starts all processes; the source of frames starts last, when the others are ready. Returns false when the run is
/// over before that.
bool Supervisor::start_all() {
  for (auto& process : processes_) {
    if (&process != &source()) start(process);
  }
  const auto is_ready = [this](const Process& process) { return &process == &source() || process.pulse->is_ready(); };
  while (!is_over() && !std::all_of(processes_.begin(), processes_.end(), is_ready)) turn();
  if (is_over()) return false;
  start(source());
  return true;
}

void Supervisor::wait_until_over() {
  while (!is_over()) {
    turn();
    for (const auto& process : processes_) {
      if (process.name == system_.shows && process.pulse) progress_.show(process.pulse->activity());
    }
  }
}

/// Listens for a short time, and then checks each process.
void Supervisor::turn() {
  executor_.spin_once(kTurn);
  const double now = now_s();
  if (now - turned_s_ > kAbsent_s) {
    for (auto& process : processes_) {
      if (process.pulse) process.pulse->forgive(now);
    }
  }
  turned_s_ = now;
  take_signals();
  for (const std::string& run : participant_.peers().take_other_runs()) {
    progress_.end();
    std::cerr << title_ << ": " << participant_.describe_other_run(run) << "\n";
  }
  for (auto& process : processes_) {
    if (!is_over()) look_after(process);
  }
}

void Supervisor::hear(const lapis_msgs::msg::Heartbeat& heartbeat) {
  for (auto& process : processes_) {
    if (!process.child || process.child->pid() != heartbeat.pid() || !heartbeat.name().ends_with(process.name))
      continue;
    process.pulse->hear(now_s(), {static_cast<Phase>(heartbeat.phase()), heartbeat.activity(), heartbeat.silence_s()});
  }
}

void Supervisor::take_signals() {
  const timespec at_once{};
  for (int signal = 0; (signal = sigtimedwait(&ending_signals(), nullptr, &at_once)) > 0;) {
    is_impatient_ |= interrupt_ != 0;
    if (interrupt_ == 0) interrupt_ = signal;
    if (!hurried_s_) hurried_s_ = now_s();
  }
}

/// Notes whether a process has ended or hangs, and restarts it or fails.
void Supervisor::look_after(Process& process) {
  if (!process.child || process.status) return;
  const bool is_source = &process == &source();
  if (const auto status = process.child->status()) {
    if (is_source && *status == 0) {
      process.status = status;
      has_ended_ = true;
      return;
    }
    const bool was_ready = process.pulse->is_ready();
    if (restart(process, *status, "ended with status " + std::to_string(*status))) return;
    process.status = status;
    const std::string what = is_source ? "failed" : was_ready ? "ended early" : "ended before it was ready,";
    return fail(process, what + " with status " + std::to_string(*status), *status);
  }
  if (!process.is_back && process.pulse->is_ready()) {
    process.is_back = true;
    std::cerr << title_ << ": " << process.name << " runs again\n";
  }
  if (!process.pulse->is_hung(now_s(), usual_silence_s_)) return;
  const std::string silence = "was silent for " + seconds_text(process.pulse->silence_s(now_s()));
  const std::string activity = process.pulse->activity();
  const std::string what = silence + (activity.empty() ? "" : " (last: " + activity + ")");
  process.child->kill();
  if (restart(process, *process.child->status(), what)) return;
  process.status = process.child->status();
  if (is_source) hurried_s_ = now_s();
  fail(process, what + " and was killed");
}

/// Restarts a process. Returns false when it must not be restarted: restarts are not requested, their number is used
/// up, its set-up is bad, or it is the source, whose state is that of the run.
bool Supervisor::restart(Process& process, int status, const std::string& why) {
  const int times = system_.restart.times;
  if (!request_.may_restart || process.restarts >= times || &process == &source() || status == kBadSetupStatus)
    return false;
  ++process.restarts;
  process.is_back = false;
  progress_.end();
  const std::string line = title_ + ": " + process.name + " " + why + " and is started again (" +
                           std::to_string(process.restarts) + " of " + std::to_string(times) + ")\n";
  std::cerr << line << std::flush;
  std::ofstream(folder_.log(process.name), std::ios::app) << line;
  start(process, settings_to_resume(process.name));
  return true;
}

/// Settings with which a restarted process resumes; none when there is nothing to resume.
Settings Supervisor::settings_to_resume(const std::string& process) const {
  const auto ways = system_.restart.resume.find(process);
  if (ways == system_.restart.resume.end()) return {};
  for (const Resume& way : ways->second) {
    if (exists(folder_.path() / way.file)) return with_run_folder(way.settings, folder_.path());
  }
  return {};
}

/// Ends the source first, then the others in the order of their start: a process that collects what others publish at
/// their end comes after them.
void Supervisor::end_all() {
  end(source());
  for (auto& process : processes_) end(process);
}

/// Sends SIGTERM, or SIGINT in a hurry, possibly after an earlier SIGTERM.
void Supervisor::ask_to_end(Process& process) {
  const int signal = is_in_a_hurry() ? SIGINT : SIGTERM;
  if (!process.child || process.child->status() || process.asked_by == signal) return;
  process.child->send(signal);
  process.pulse->ask_to_end(now_s());
  process.asked_by = signal;
}

void Supervisor::end(Process& process) {
  if (!process.child || process.status) return;
  const auto hurried_for_s = [this] { return hurried_s_ ? now_s() - *hurried_s_ : 0.0; };
  while (!(process.status = process.child->status())) {
    ask_to_end(process);
    if (hurried_for_s() > kInOrder_s)
      std::for_each(processes_.begin(), processes_.end(), [this](auto& p) { ask_to_end(p); });
    executor_.spin_once(kTurn);
    take_signals();
    const bool has_no_time = is_impatient_ || hurried_for_s() > kHurry_s;
    if (!has_no_time && !process.pulse->is_hung(now_s(), is_in_a_hurry() ? kHurriedSilence_s : usual_silence_s_))
      continue;
    process.child->kill();
    process.status = process.child->status();
    std::cerr << title_ << ": " << process.name << " did not end and was killed\n";
    return;
  }
}

void Supervisor::fail(const Process& process, const std::string& what, int status) {
  if (!failure_) failure_ = {process.name, what, status == kBadSetupStatus ? kBadSetupStatus : 1};
}

/// Prints the outcome of the run and returns its exit status.
int Supervisor::conclude() {
  if (!failure_ && interrupt_ == 0) {
    for (const auto& process : processes_) {
      const int status = process.status.value_or(0);
      if (status != 0) fail(process, "failed with status " + std::to_string(status), status);
    }
    if (!failure_ && !system_.result.empty() && !exists(folder_.path() / system_.result)) {
      fail(processes_.front(), "no frame came; the reason may be here or in the other logs");
    }
  }
  if (!failure_ || failure_->process == system_.source) print_report();
  if (interrupt_ != 0) {
    std::cerr << title_ << ": interrupted by SIG" << sigabbrev_np(interrupt_) << "; what was played is in "
              << folder_.path().string() << '\n';
    return 128 + interrupt_;
  }
  if (failure_) {
    std::cerr << title_ << ": " << failure_->process << ": " << failure_->what << "; the end of "
              << folder_.log(failure_->process).string() << ":\n"
              << folder_.end_of_log(failure_->process);
    return failure_->status;
  }
  std::cout << "run folder: " << folder_.path().string() << std::endl;
  return 0;
}

void Supervisor::write_manifest() const {
  Manifest manifest{request_.command, facts(), {}};
  for (const auto& process : processes_) {
    manifest.processes.push_back({process.name, process.status, process.restarts, process.configuration.text});
  }
  files::replace_text(folder_.path() / kManifest, to_yaml(manifest, read_text(folder_.path() / "simulation.yaml")));
}

void Supervisor::add_facts_to_metrics() const {
  const auto file = folder_.path() / "metrics.json";
  if (exists(file)) files::replace_text(file, with_facts(read_text(file), facts()));
}

void Supervisor::print_report() const {
  if (!system_.report.empty()) std::cout << read_text(folder_.path() / system_.report) << std::flush;
}

}  // namespace lapis::supervisor
