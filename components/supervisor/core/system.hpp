#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lapis::supervisor {

/// One configuration value of a process: "slam.noise.max_depth_m" and its value as YAML text.
struct Setting {
  std::string key;
  std::string value;

  bool operator==(const Setting&) const = default;
};
using Settings = std::vector<Setting>;

/// What a restarted process resumes from, when the file is in the run folder.
struct Resume {
  std::string file;
  Settings settings;
};

/// What is done about a process that dies: only with --restart.
struct RestartPolicy {
  int times = 0;      ///< of each process
  Settings settings;  ///< of a run that may restart processes
  std::map<std::string, Resume> resume;
};

/// Another kind of the run, chosen by --variant.
struct Variant {
  std::string silence;  ///< as System::silence; empty: the same
  Settings settings;
};

/// A run of several processes, as config/systems/<name>.yaml describes it. Programs are lapis_<process>.
struct System {
  std::string name;
  std::vector<std::string> processes;      ///< in the order of their start, in which they are ended, too
  std::string source;                      ///< of frames: the last to start, the first to end; the run is over with it
  std::vector<std::string> stages;         ///< of lock-step
  Settings settings;                       ///< before those of the user
  std::vector<std::string> configuration;  ///< files, each for the processes that know all its sections
  std::map<std::string, std::string> facts;  ///< of the run, for manifest.yaml and metrics.json: name, key of the value
  std::string shows;                         ///< process whose progress is shown
  std::string silence;                       ///< [s], or the key of a value: silent for longer, a process hangs
  std::string report;                        ///< file of the run folder that is printed at the end
  std::string result;                        ///< file of the run folder without which the run has failed
  std::vector<std::string> results;          ///< patterns of the files that a run leaves
  std::map<std::string, Variant> variants;
  RestartPolicy restart;
};

/// Nothing, or what contradicts itself in the description, with the remedy.
std::optional<std::string> find_problem(const System& system);

}  // namespace lapis::supervisor
