#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/executor.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/subscription.hpp"
#include "common/topics/heartbeat.hpp"
#include "supervisor/child.hpp"
#include "supervisor/core/pulse.hpp"
#include "supervisor/core/system.hpp"
#include "supervisor/manifest.hpp"
#include "supervisor/program.hpp"
#include "supervisor/progress_line.hpp"
#include "supervisor/run_folder.hpp"

namespace lapis::supervisor {

/// What the user requests of a run.
struct Request {
  std::filesystem::path out;       ///< run folder
  std::filesystem::path programs;  ///< folder of lapis_<process>
  std::vector<std::string> variants;
  bool may_restart = false;
  std::vector<std::string> configuration;    ///< files; they override those of the system
  Settings settings;                         ///< they override those of the system
  std::map<std::string, std::string> facts;  ///< name -> text
  std::string command;                       ///< the command that was called, for messages
};

/// Blocks SIGINT, SIGTERM and SIGHUP (unless that is ignored), which the supervisor's own loop receives, and ignores
/// SIGPIPE. To be called before any thread starts.
void block_signals();

/// One run: its processes from their start to their end, and the run folder (docs/architecture.md, "Supervision").
class Supervisor {
 public:
  /// Locks the run folder, and has each program check its configuration. Throws BadSetup.
  Supervisor(System system, Request request);

  /// Returns the exit status of the run.
  int run();

 private:
  struct Process {
    std::string name;
    std::vector<std::string> arguments;
    PrintedConfiguration configuration;
    std::unique_ptr<Child> child;
    std::optional<Pulse> pulse;
    std::optional<int> status;  ///< exit status of a process that has ended for good
    int restarts = 0;
    bool is_back = true;  ///< false from a restart until it runs again
    int asked_by = 0;     ///< signal by which it was asked to end
  };

  // Preparation
  Settings all_settings() const;
  std::vector<std::pair<std::string, std::set<std::string>>> configuration_files(const Configurations& known) const;
  void collect_arguments();
  void clear_folder() const;
  double usual_silence() const;
  Facts facts() const;

  // The run
  void start(Process& process, const Settings& more = {});
  Settings settings_to_resume(const std::string& process) const;
  bool start_all();
  void wait_until_over();
  void look_after(Process& process);
  bool restart(Process& process, int status, const std::string& why);
  void turn();
  void hear(const lapis_msgs::msg::Heartbeat& heartbeat);
  void take_signals();

  // The end
  void end_all();
  void ask_to_end(Process& process);
  void end(Process& process);
  void fail(const Process& process, const std::string& what, int status = 1);
  int conclude();
  void write_manifest() const;
  void add_facts_to_metrics() const;
  void print_report() const;

  Process& source() { return processes_.back(); }
  double now_s() const;
  bool is_in_a_hurry() const { return hurried_s_.has_value(); }
  bool is_over() const { return has_ended_ || interrupt_ != 0 || failure_.has_value(); }

  System system_;
  Request request_;
  std::string title_;  ///< in front of messages
  RunFolder folder_;
  Settings settings_;  ///< settings of the run; later ones win
  std::vector<Process> processes_;
  double usual_silence_s_ = 0.0;

  dds::Participant participant_;
  dds::Executor executor_;
  dds::Subscription<lapis_msgs::msg::Heartbeat> heartbeats_;
  ProgressLine progress_;

  double turned_s_ = 0.0;            ///< time of the last turn of the loop
  bool has_ended_ = false;           ///< the source of frames has ended by itself
  int interrupt_ = 0;                ///< the first signal that arrived
  std::optional<double> hurried_s_;  ///< since when the end is urgent
  bool is_impatient_ = false;        ///< a second signal has arrived
  /// The first failure: process, what happened, exit status of the run.
  struct Failure {
    std::string process;
    std::string what;
    int status = 1;
  };
  std::optional<Failure> failure_;
};

}  // namespace lapis::supervisor
