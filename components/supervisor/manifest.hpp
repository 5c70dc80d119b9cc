#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lapis::supervisor {

/// Scene, method, seed, commit, ... of a run as YAML scalars. Text is always in quotes, because it may look like a
/// number, such as the commit 6007e82.
using Facts = std::map<std::string, std::string>;

/// Content of a run's manifest.yaml.
struct Manifest {
  std::string command;  ///< command that started the run
  Facts facts;
  struct Process {
    std::string name;
    std::optional<int> status;  ///< none while it runs
    int restarts = 0;
    std::string configuration;  ///< YAML
  };
  std::vector<Process> processes;
};

/// A YAML document, which is valid whatever the texts are. `simulation`: content of the source's simulation.yaml, or
/// empty.
std::string to_yaml(const Manifest& manifest, const std::string& simulation);

/// Adds the facts of a run to the metrics of its evaluation, as section "run", and returns the new content. Throws an
/// exception derived from std::exception when `metrics` is not JSON.
std::string with_facts(const std::string& metrics, const Facts& facts);

}  // namespace lapis::supervisor
