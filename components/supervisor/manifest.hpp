#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lapis::supervisor {

/// Scene, method, seed, commit, ... of a run as YAML scalars. What is text is in quotes, whatever it looks like: the
/// commit 6007e82 is no number.
using Facts = std::map<std::string, std::string>;

/// What manifest.yaml says of a run.
struct Manifest {
  std::string command;  ///< that started it
  Facts facts;
  struct Process {
    std::string name;
    std::optional<int> status;  ///< none while it runs
    int restarts = 0;
    std::string configuration;  ///< YAML
  };
  std::vector<Process> processes;
};

/// A YAML document, whatever the texts are. `simulation`: content of the source's simulation.yaml, or empty.
std::string to_yaml(const Manifest& manifest, const std::string& simulation);

/// Adds the facts of a run to the metrics of its evaluation, as section "run". Returns the new content. Throws
/// std::runtime_error when `metrics` is not JSON.
std::string with_facts(const std::string& metrics, const Facts& facts);

}  // namespace lapis::supervisor
