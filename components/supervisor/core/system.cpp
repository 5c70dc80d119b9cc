#include "supervisor/core/system.hpp"

#include <algorithm>

namespace lapis::supervisor {

System varied(System system, const Variant& variant) {
  if (!variant.silence.empty()) system.silence = variant.silence;
  if (!variant.processes.empty()) system.processes = variant.processes;
  if (!variant.stages.empty()) system.stages = variant.stages;
  system.processes.insert(system.processes.end() - (system.processes.empty() ? 0 : 1), variant.adds.begin(),
                          variant.adds.end());
  system.stages.insert(system.stages.end(), variant.adds.begin(), variant.adds.end());
  system.settings.insert(system.settings.end(), variant.settings.begin(), variant.settings.end());
  return system;
}

std::optional<std::string> find_problem(const System& system) {
  const auto& processes = system.processes;
  const auto is_process = [&](const std::string& name) {
    return std::find(processes.begin(), processes.end(), name) != processes.end();
  };
  if (processes.empty()) return "processes: name at least one";
  for (const auto& name : processes) {
    if (std::count(processes.begin(), processes.end(), name) > 1) return "processes: " + name + " is there twice";
  }
  if (processes.back() != system.source) return "source: has to be the last of the processes, which starts last";
  for (const auto& stage : system.stages) {
    if (!is_process(stage)) return "stages: " + stage + " is not one of the processes";
  }
  if (!system.shows.empty() && !is_process(system.shows))
    return "shows: " + system.shows + " is not one of the processes";
  for (const auto& [name, resume] : system.restart.resume) {
    if (!is_process(name)) return "restart.resume: " + name + " is not one of the processes";
  }
  if (system.silence.empty()) return "silence_s: give seconds, or the key of a value in seconds";
  for (const auto& [name, variant] : system.variants) {
    System as_variant = varied(system, variant);
    as_variant.variants.clear();
    if (const auto problem = find_problem(as_variant)) return "variants: " + name + ": " + *problem;
  }
  return std::nullopt;
}

}  // namespace lapis::supervisor
