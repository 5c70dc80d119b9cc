#pragma once

#include <optional>

#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// The job that needs no DDS which the command line asks for, such as --validate: its exit status; nothing when none is
/// asked for.
/// @throws std::runtime_error with one line for a scene or a folder that cannot be used
std::optional<int> run_scene_tool(const SimulatorConfig& config);

}  // namespace lapis::simulator
