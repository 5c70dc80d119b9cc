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

/// Settings with which a restarted process resumes when the file exists in the run folder.
struct Resume {
  std::string file;
  Settings settings;
};

/// How processes that die or hang are restarted; only with --restart.
struct RestartPolicy {
  int times = 0;                                      ///< largest number of restarts of each process
  Settings settings;                                  ///< additional settings of a run that may restart processes
  std::map<std::string, std::vector<Resume>> resume;  ///< the first whose file exists counts
};

/// A variant of the run, selected with --variant.
struct Variant {
  std::string silence;  ///< see System::silence; empty: the same as there, and so for processes and stages
  Settings settings;    ///< after those of the system
  std::vector<std::string> processes;
  std::vector<std::string> stages;
  std::vector<std::string> adds;  ///< processes before the source, which are stages, too, after all others
};

/// A run of several processes, as config/systems/<name>.yaml describes it. Programs are lapis_<process>.
struct System {
  std::string name;
  std::vector<std::string> processes;      ///< in the order of their start, which is also the order of their end
  std::string source;                      ///< of frames; starts last and ends first; the run ends with it
  std::vector<std::string> stages;         ///< stages of lock-step
  Settings settings;                       ///< those of the user override them
  std::vector<std::string> configuration;  ///< files, each for the processes that know all of its sections
  /// Facts of the run for manifest.yaml and metrics.json: name -> key of the value.
  std::map<std::string, std::string> facts;
  std::string shows;                 ///< process whose progress is shown
  std::string silence;               ///< [s], or the key of a value: a process that is silent for longer hangs
  std::string report;                ///< file of the run folder that is printed at the end
  std::string result;                ///< file of the run folder without which the run has failed
  std::vector<std::string> results;  ///< patterns of the files that a run leaves
  std::map<std::string, Variant> variants;
  RestartPolicy restart;
};

/// The system as one of its variants.
System varied(System system, const Variant& variant);

/// The contradiction in the description, with the remedy; nothing when there is none.
std::optional<std::string> find_problem(const System& system);

}  // namespace lapis::supervisor
