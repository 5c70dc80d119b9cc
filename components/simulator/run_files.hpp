#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "simulator/core/simulation.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// State and reason in the last status of the planner.
struct PlannerEnd {
  std::string state;
  std::string reason;
};

/// Result of a run.
struct RunSummary {
  std::string exit_reason;
  std::uint64_t frames = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
  std::uint64_t collisions = 0;
  double hardest_push_m_s = 0.0;
  std::optional<PlannerEnd> planner;             ///< with simulator.ends_when_explored, once a status has arrived
  std::map<std::string, double> cpu_ms;          ///< by participant of lock-step
  std::map<std::string, std::uint64_t> demoted;  ///< by participant: the tick from which the run continued without it
};

/// Text of simulation.yaml in the run folder: what is needed to repeat the run, and its result.
std::string to_yaml(const RunSummary& summary, const World& world, const StartPose& start,
                    const SimulatorConfig& config);

std::filesystem::path truth_folder(const SimulatorConfig& config);
/// Map of a mapper with the default configuration on this robot, for ground truth when there is no mapper.
mapping::MapDescription default_map(const SimulatorConfig& config);
void add_to(IdealMap& ideal, const SensorFrame& frame, const World& world, const StartPose& start,
            const SimulatorConfig& config);
/// Writes the part of the ground truth that does not depend on the run's path into a folder whose parent exists. Voxels
/// and frame settings are those of `map`. When it is cancelled, it leaves out the files that are not complete.
/// @throws std::runtime_error naming the file that cannot be written
void write_truth(const World& world, const StartPose& start, const SimulatorConfig& config,
                 const mapping::MapDescription& map, const std::filesystem::path& folder,
                 const std::stop_token& cancelled = {});

}  // namespace lapis::simulator
