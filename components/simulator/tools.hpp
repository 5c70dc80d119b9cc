#pragma once

#include <optional>

#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Runs the tool that the command line asks for, such as --validate, without DDS. Returns its exit status; nothing when
/// the command line asks for no tool.
/// @throws std::runtime_error with one line for a scene or a folder that cannot be used
std::optional<int> run_scene_tool(const SimulatorConfig& config);

}  // namespace lapis::simulator
