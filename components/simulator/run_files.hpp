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

/// What the planner said last.
struct PlannerEnd {
  std::string state;
  std::string reason;
};

/// How a run went.
struct RunSummary {
  std::string exit_reason;
  std::uint64_t frames = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
  std::uint64_t collisions = 0;
  double hardest_push_m_s = 0.0;
  std::optional<PlannerEnd> planner;             ///< when the run waits for its end and it has spoken
  std::map<std::string, double> cpu_ms;          ///< by participant of lock-step
  std::map<std::string, std::uint64_t> demoted;  ///< participants without which the run continued, from which tick on
};

/// simulation.yaml of the run folder: what is needed to repeat the run, and how it went.
std::string to_yaml(const RunSummary& summary, const World& world, const StartPose& start,
                    const SimulatorConfig& config);

std::filesystem::path truth_folder(const SimulatorConfig& config);
/// The map of a mapper that nobody configured, on this robot: for ground truth where no mapper is.
mapping::MapDescription default_map(const SimulatorConfig& config);
void add_to(IdealMap& ideal, const SensorFrame& frame, const World& world, const StartPose& start,
            const SimulatorConfig& config);
/// Writes the ground truth of a scene, as far as it does not depend on the run's path, into a folder whose parent
/// exists, for a map with these voxels and frames; nothing when it is cancelled before it is complete.
/// @throws std::runtime_error naming the file that cannot be written
void write_truth(const World& world, const StartPose& start, const SimulatorConfig& config,
                 const mapping::MapDescription& map, const std::filesystem::path& folder,
                 const std::stop_token& cancelled = {});

}  // namespace lapis::simulator
